"""Cases drawn at random as a user asks for them, and how far off a run is beside another."""

import io
import math

import numpy as np
import pytest
from rich.console import Console

from reports.beside import beside, load_other
from reports.ci import markdown
from reports.results import Missing, load_results, save_results
from reports.terminal import print_beside
from scenes.draw.suite import draw_suite
from scenes.suite import Sampling, load_suite


def test_a_drawn_suite_is_judged_like_any_other(shadeproof, tmp_path):
    few = Sampling(samples_per_batch=4, max_samples=32)
    base = load_suite("tiny")[0].model_copy(update={"techniques": ("paper",), "reference": few})
    path = draw_suite(base, "tiny", 4, 1, tmp_path / "drawn", 0.03)
    edited = path.read_text().replace("rotation", "resolution = [64, 48]\nrotation")
    path.write_text(edited)  # an ordinary file
    code, said, err = shadeproof("gate", "--suite", path, "--out", tmp_path / "out")
    assert code in (0, 1), err
    results = load_results(tmp_path / "out/results.json")
    assert results.rows and not results.missing and not any(r.problem for r in results.rows)
    judged = [r for r in results.rows if r.truth == "unoccluded"]
    assert judged and all(r.budget["energy_local"] == pytest.approx(0.3) for r in judged)
    assert "drawn4-0" in said


def test_draw_writes_ordinary_files_that_run_again(shadeproof, tmp_path):
    words = "--draw", "3", "--count", "1", "--out", tmp_path, "--list"
    code, listed, err = shadeproof("compare", *words)
    assert code == 0 and listed.startswith("drawn3-0."), err
    suite = tmp_path / "drawn/3/suite.toml"
    assert "--draw 3 --count 1" in suite.read_text()
    assert shadeproof("compare", "--suite", suite, "--list")[:2] == (0, listed)


def test_what_a_suite_asks_is_asked_of_drawn_cases(shadeproof, tmp_path):
    words = "--suite", "spheres", "--draw", "3", "--count", "1", "--out", tmp_path, "--list"
    assert shadeproof("compare", *words)[0] == 0
    suite, base = (load_suite(str(s))[0] for s in (tmp_path / "drawn/3/suite.toml", "spheres"))
    assert (suite.techniques, suite.truths) == (base.techniques, base.truths)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--draw", "x"), "--draw: 'x' does not fit; give a whole number"),
        (("--draw", "1.5"), "--draw: '1.5' does not fit; give a whole number"),
        (("--draw", "-1"), "--draw: '-1' does not fit; give a number from 0 up"),
        (("--draw", str(2**60)), "does not fit; give a number up to 999999"),
        (("--draw", "1", "--count", "0"), "--count: '0' does not fit; give a number from 1 up"),
        (("--draw", "1", "--count", "1000"), "'1000' does not fit; give a number up to 200"),
        (("--count", "3"), "--count: 3: counts drawn cases; add --draw SEED"),
        (("--draw", "1", "--suite", "none"), "unknown name 'none'"),
    ],
)
def test_a_slip_ends_in_one_line(shadeproof, tmp_path, words, said):
    code, out, err = shadeproof("compare", *words, "--out", tmp_path / "out")
    assert code == 2 and out == ""
    assert said in err and len(err.splitlines()) == 1
    assert not (tmp_path / "out/drawn").exists()


def test_a_folder_that_cannot_be_written_is_told(shadeproof, tmp_path):
    (tmp_path / "file").touch()
    code, _, err = shadeproof("compare", "--draw", "1", "--out", tmp_path / "file")
    assert code == 2 and "--out" in err and len(err.splitlines()) == 1


@pytest.fixture
def runs(tiny):
    """A run, and one whose errors are half as large."""
    ours = load_results(tiny / "results.json")
    halved = [
        r.model_copy(
            update={
                "energy_error": -r.energy_error / 2,
                "energy_local": r.energy_local / 2,
                "ssim": 1 - (1 - r.ssim) / 2,
            }
        )
        for r in ours.rows
    ]
    return ours, ours.model_copy(update={"rows": halved, "suite": "other"})


def test_ratios_are_of_medians_and_worst_rows(runs, tmp_path):
    ours, other = runs
    found = beside(ours, other, tmp_path / "results.json").beside
    pairs = {(r.technique, r.truth) for r in ours.rows}
    assert {(r.technique, r.truth) for r in found.ratios} == pairs
    assert len(found.ratios) == 3 * len(pairs)
    for ratio in found.ratios:
        assert ratio.median_ratio == pytest.approx(2) and ratio.worst_ratio == pytest.approx(2)
        assert (ratio.rows, ratio.other_rows) == (3, 3)
    local = next(r for r in found.ratios if r.figure == "energy_local")
    own = [
        r.energy_local
        for r in ours.rows
        if (r.technique, r.truth) == (local.technique, local.truth)
    ]
    assert (local.median, local.worst) == (np.median(own), max(own))


def test_rows_without_figures_and_errors_that_noise_hides_give_no_ratio(runs, tmp_path):
    ours, other = runs
    lost = ours.rows[0].model_copy(update={"energy_error": math.nan, "problem": "blank"})
    perfect = [r.model_copy(update={"ssim": 1.001}) for r in other.rows]
    found = beside(
        ours.model_copy(update={"rows": [lost, *ours.rows[1:]]}),
        other.model_copy(update={"rows": perfect}),
        tmp_path,
    ).beside
    mine = [r for r in found.ratios if (r.technique, r.truth) == (lost.technique, lost.truth)]
    assert [r.rows for r in mine if r.figure == "energy_error"] == [2]
    hidden = [r for r in found.ratios if r.figure == "1 - ssim"]
    assert all(math.isnan(r.median_ratio) for r in hidden)
    assert "hidden by noise" in _printed(found)


def test_the_ratios_stand_in_terminal_summary_and_results(runs, tmp_path):
    ours, other = runs
    told = beside(ours, other, tmp_path / "other.json")
    save_results(told, tmp_path / "results.json")
    assert load_results(tmp_path / "results.json").beside == told.beside
    assert "2.00 x" in _printed(told.beside) and "beside other" in _printed(told.beside)
    text = markdown(told)
    assert "How far off, beside other" in text and text.count("2.00 x") == 2 * len(
        told.beside.ratios
    )
    assert "beside" not in markdown(ours)


def _printed(found):
    page = io.StringIO()
    print_beside(found, Console(file=page, width=160))
    return page.getvalue()


def test_results_of_other_techniques_are_refused(runs, tmp_path, refused):
    save_results(runs[0], tmp_path / "results.json")
    expected = [Missing(case="c", object="o", technique="best", truth="global")]
    words = "--beside", "paper against global", "give results"
    refused(lambda: load_other(tmp_path / "results.json", expected), *words)


def test_a_run_beside_itself_is_once_as_far_off(shadeproof, tiny, tmp_path):
    words = "--suite", "tiny", "--out", tmp_path / "out", "--beside", tiny / "results.json"
    code, said, err = shadeproof("compare", *words)
    assert code == 0 and "How far off, beside tiny" in said, err
    ratios = load_results(tmp_path / "out/results.json").beside.ratios
    assert ratios and all(r.worst_ratio == 1 or math.isnan(r.worst_ratio) for r in ratios)


def test_another_runs_results_are_read_before_anything_is_drawn(shadeproof, tmp_path):
    words = "--suite", "tiny", "--out", tmp_path / "out", "--beside", tmp_path / "none.json"
    code, out, err = shadeproof("compare", *words)
    assert code == 2 and out == "" and "no such file" in err and len(err.splitlines()) == 1
    assert not (tmp_path / "out").exists()
