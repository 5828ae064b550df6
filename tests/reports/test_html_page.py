"""report.html: whole, offline, honest about what failed, and worst first."""

import re

import numpy as np
import pytest

from reports.gate import judge
from reports.html import write_report
from reports.html.figures import METRICS, percent
from reports.html.template import pasted
from reports.results import CaseRecord, Missing, Results
from scenes.frame import Frame, save_frame
from tests.reports.pages import BUDGET, Page, results, row, written


def test_asks_for_nothing_outside_the_page(folder):
    text = written(results([row()]), folder)
    page = Page(text)
    for tag, attributes in page.elements:
        for name in ("src", "srcset", "data", "poster", "action"):
            assert attributes.get(name, "data:").startswith("data:"), (tag, attributes[name][:80])
        assert attributes.get("href", "#").startswith(("#", "data:")), tag
    # Without the images' own letters, in which anything can occur.
    bare = re.sub(r"data:image/png;base64,[\w+/=]+", "", text)
    bare = re.sub(r'<script type="text/plain"[^>]*>[\w+/=]+<', "", bare)
    assert not re.search(r"https?:|//\w|@import|url\(|fetch\(|XMLHttp|import\(", bare)
    (policy,) = [a["content"] for t, a in page.elements if "http-equiv" in a and t == "meta"]
    assert "default-src 'none'" in policy


def test_holds_together(folder):
    page = Page(written(results([row(), row(object="right", weight=0.5)]), folder))
    ids = [a["id"] for _, a in page.elements if "id" in a]
    assert len(ids) == len(set(ids))
    links = {a["href"][1:] for t, a in page.elements if t == "a"}
    assert links <= set(ids)
    assert {"case--spheres.dusk", "row--spheres.dusk--left--paper--global"} <= set(ids)
    for tag, attributes in page.elements:
        assert tag != "th" or "scope" in attributes
        assert tag != "img" or attributes["alt"]


def test_verdict_names_the_worst(folder):
    rows = [
        row(material="gold", energy_local=0.25, energy_local_ci95=(0.24, 0.26)),
        row(object="right", material="silver", weight=0.75, energy_local=0.312,
            energy_local_ci95=(0.31, 0.314)),
    ]  # fmt: skip
    text = Page(written(results(rows), folder)).text["h1"].replace("\u202f", " ")
    assert text == (
        "FAIL: silver (weight 0.75) on right in spheres.dusk misses its local energy budget: "
        "31.2 % ± 0.2 % against 20 % (paper vs global)."
    )


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({}, "PASS: every budget is kept, the closest is"),
        ({"energy_local_ci95": (0.05, 0.3)}, "FAIL: noise hides whether copper (weight 0.25)"),
        ({"truth": "unoccluded"}, "so nothing was judged; the largest local energy error is 10.0"),
    ],
)
def test_verdict_says_what_kind_of_worst(folder, fields, words):
    assert words in Page(written(results([row(**fields)]), folder)).text["h1"]


def test_a_run_without_budgets_is_reported_and_not_failed(folder):
    run = results([judge(row(), [])], budgets=[])
    page = Page(written(run, folder))
    assert page.text["h1"].startswith("REPORTED: no row has a budget, so nothing was judged")
    assert page.text["title"].startswith("REPORTED")
    assert [a["class"] for t, a in page.elements if t == "h1"] == ["verdict reported"]


def test_verdict_of_a_run_without_rows(folder):
    assert "no case was compared" in Page(written(results([]), folder)).text["h1"]


def test_missing_rows_fail_even_where_all_others_pass(folder):
    lost = Missing(case="spheres.dusk", object="right", technique="paper", truth="global")
    page = Page(written(results([row()], missing=[lost], expected_rows=2), folder))
    assert page.text["h1"].startswith("FAIL: 1 of 2 rows are missing")
    assert "Missing: right, paper vs global" in page.text["section"]


def test_a_row_that_failed_is_seen_with_its_problem(folder):
    broken = row(technique="outside", problem="exit code 139", ssim=np.nan, energy_local=np.nan)
    page = Page(written(results([row(), broken]), folder))
    assert "could not be compared: exit code 139" in page.text["h1"]
    assert "exit code 139" in page.text["table"]
    assert "No picture: exit code 139" in page.text["figure"]
    assert "nan" not in page.text["table"].lower().replace("nan / inf", "")


def test_hostile_names_stay_text(folder):
    evil = "<script>alert(1)</script>\"' onerror=x"
    run = results([row(material=evil, technique=evil, problem=evil)], command=evil, suite=evil)
    page = Page(written(run, folder))
    assert sum(t == "script" and "type" not in a for t, a in page.elements) == 1
    assert not any("onerror" in a for _, a in page.elements)
    assert evil in page.text["h1"] and evil in page.text["code"]


def test_same_results_make_the_same_bytes(folder):
    run = results([row(), row(object="right")])
    assert written(run, folder) == written(run, folder)


@pytest.mark.parametrize(
    ("expected", "words"),
    [
        (3, "PASS (1 of 3 rows were asked for; 2 cases skipped by the filter): every"),
        (1, "PASS (only a part of the suite was asked for; 2 cases skipped by the filter): every"),
    ],
)
def test_skipped_cases_are_told(folder, expected, words):
    skipped = ["spheres.noon (filter 'dusk')", "spheres.night (filter 'dusk')"]
    page = Page(written(results([row()], expected_rows=expected, skipped=skipped), folder))
    assert page.text["h1"].startswith(words)
    assert "2 cases skipped" in page.text["dl"]
    assert all(f"skipped: {s}" in page.text["details"] for s in skipped)


def test_a_pass_says_what_it_does_not_promise(folder):
    override = BUDGET.model_copy(update={"material": "gold", "reason": "gold is hard"})
    rows = [row(), row(object="right", material="gold")]
    text = written(results(rows, budgets=[BUDGET, override]), folder)
    assert "not a promise of quality; 1 of 2 rows use an override with a reason." in text
    assert "no row uses an override" in written(results([row()]), folder)
    failing = row(energy_local=0.9, energy_local_ci95=(0.8, 1.0))
    assert "promise of quality" not in written(results([failing]), folder)


@pytest.mark.parametrize("value", [np.inf, np.nan])
def test_an_infinite_or_lost_figure_is_text(folder, value):
    lost = row(energy_local=value, energy_local_ci95=(value, value))
    run = results([lost])
    again = Results.model_validate_json(run.model_dump_json())  # where infinity is null
    for page in (Page(written(r, folder)) for r in (run, again)):
        assert "local energy budget" in page.text["h1"]
        assert not re.search(r"\b(nan|inf)\b", page.text["table"].replace("NaN / Inf", ""), re.I)
    assert "has no figure to hold against its local energy budget of 20" in page.text["h1"]
    half = row().model_copy(update={"energy_local_ci95": (0.05, np.inf)})
    assert "unknown" in METRICS["energy_local"].spread(half)
    written(results([half], seconds=np.inf), folder)


@pytest.mark.parametrize(
    ("value", "text"), [(0.31234, "31.2 %"), (-0.0123, "−1.23 %"), (2.5, "250 %"), (np.nan, "–")]
)
def test_percentages_have_three_digits_and_a_unit(value, text):
    assert percent(value).replace("\u202f", " ") == text


def test_a_suite_stays_small(tmp_path):
    """One noisy case of 640x232, 4 objects, 3 techniques, 3 truths: five such within 25 MB."""
    rng, shape = np.random.default_rng(1), (232, 640)
    ids = np.zeros(shape, np.uint8)
    for i in range(4):
        ids[40:190, 20 + 155 * i : 155 + 155 * i] = 1 + i  # 55 % of the picture
    names, techniques, truths = "abcd", ("p", "q", "r"), ("unoccluded", "global", "physical")

    def save(name):
        """Light that changes from object to object, with 1 % of grain."""
        rgb = (0.5 + 0.1 * ids[..., None]) * rng.normal(1, 0.01, (*shape, 3))
        save_frame(Frame(rgb.astype(np.float32), ids), tmp_path / name)
        return name

    case = CaseRecord(
        id="c", scene="s", environment="e", width=640, height=232, objects=list(names),
        candidates={t: save(f"{t}.exr") for t in techniques},
        truths={t: (save(f"{t}.a.exr"), save(f"{t}.b.exr")) for t in truths},
    )  # fmt: skip
    rows = [
        row(case="c", object=o, technique=t, truth=u)
        for o in names for t in techniques for u in truths
    ]  # fmt: skip
    path = write_report(results(rows, cases=[case]), tmp_path)
    assert 5 * path.stat().st_size < 25e6


def test_commands_run_when_they_are_pasted_in_the_project(folder):
    (folder / "stability.json").write_text("{")
    page = Page(written(results([row()]), folder))
    (folder / "stability.json").unlink()
    assert ".venv/bin/shadeproof compare --suite tiny" in page.text["code"]
    assert "run `.venv/bin/shadeproof stability` again" in page.text["p"]
    assert pasted("./my-shadeproof tool") == "./my-shadeproof tool"
