"""One's own references: a folder of batches in place of our path tracer's."""

import subprocess
import sys

import numpy as np
import pytest

from reports.results import load_results
from scenes.frame import Frame, load_frame, save_frame
from tests.reports.small import small_suite

CASE = "contact.studio"
# The command where the extras `renderer` and `reference` are not installed.
ALONE = """
import sys
for package in ("moderngl", "glcontext", "mitsuba", "drjit"):
    sys.modules[package] = None
from reports.cli import main
main()
"""


@pytest.fixture
def own(tiny, tmp_path):
    """Eight batches of the case as another path tracer would leave them, and its picture."""
    truth = load_frame(tiny / f"truths/{CASE}/global.a.exr").rgb
    rng = np.random.default_rng(1)
    for number in range(8):
        noisy = truth * (1 + rng.normal(0, 0.05, truth.shape))
        save_frame(
            Frame(np.maximum(noisy, 0).astype(np.float32)), tmp_path / f"own/{CASE}/{number}.exr"
        )
    save_frame(Frame(truth * np.float32(1.1)), tmp_path / f"mine/{CASE}.exr")
    return tmp_path


def compared(shadeproof, own, *words):
    code, out, err = shadeproof(
        "compare", "--suite", "tiny", "--truth", own / "own", "--out", own / "out", *words
    )
    assert code == 0, out + err
    return load_results(own / "out/results.json")


def test_a_folder_of_pictures_is_judged_by_a_folder_of_references(shadeproof, own):
    found = compared(shadeproof, own, "--candidate", own / "mine", "--store", own / "none")
    assert {r.truth for r in found.rows} == {"global"}
    for row in found.rows:
        assert row.energy_error == pytest.approx(0.1, abs=0.01)
        assert row.reference_batches == 8 and np.isfinite(row.energy_ci95).all()
    assert not list((own / "none").glob("**/*.exr"))  # nothing was traced
    assert (own / "out/report.html").is_file()


def test_our_own_techniques_can_be_held_against_it_too(shadeproof, own):
    found = compared(shadeproof, own)
    assert {r.technique for r in found.rows} == {
        "paper",
        "sampled",
    } and not found.ladders  # of one truth


def test_other_truths_stand_in_folders_of_their_own(shadeproof, own):
    for path in sorted((own / f"own/{CASE}").glob("*.exr")):
        save_frame(load_frame(path), own / f"own/{CASE}/direct/{path.name}")
    found = compared(shadeproof, own, "--candidate", own / "mine")
    assert {r.truth for r in found.rows} == {"global", "direct"}


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda folder: [p.unlink() for p in folder.glob("*.exr")], "holds no batch of"),
        (lambda folder: save_frame(Frame(np.ones((4, 4, 3), np.float32)), folder / "0.exr"), "4x4"),
        (lambda folder: (folder / "0.exr").write_text("no"), "0.exr"),
    ],
)
def test_what_is_no_reference_is_refused_in_one_line(shadeproof, own, spoil, words):
    spoil(own / f"own/{CASE}")
    code, _, err = shadeproof(
        "compare", "--suite", "tiny", "--truth", own / "own", "--candidate", own / "mine",
        "--out", own / "out",
    )  # fmt: skip
    assert code == 2 and words in err and "Traceback" not in err


@pytest.mark.parametrize("value", [-1.0, np.inf, np.nan])
def test_what_is_no_light_is_no_reference(shadeproof, own, value):
    rgb = load_frame(own / f"own/{CASE}/0.exr").rgb.copy()
    rgb[3, 4] = value
    save_frame(Frame(rgb), own / f"own/{CASE}/0.exr")
    code, _, err = shadeproof(
        "compare", "--suite", "tiny", "--truth", own / "own", "--out", own / "out"
    )
    assert code == 2 and ("in 1 pixels" in err or "NaN" in err), err


RUNGS = ("unoccluded", "direct", "global")


@pytest.mark.parametrize(
    ("drawn", "occlusion", "interreflection"),
    [("unoccluded", 1, 1), ("direct", 0, 1), ("global", 0, 0)],
)
def test_what_a_candidate_lacks_is_told_by_ones_own_truths(
    shadeproof, tiny, own, drawn, occlusion, interreflection
):
    rng = np.random.default_rng(3)
    pictures = {t: load_frame(tiny / f"truths/{CASE}/{t}.a.exr").rgb for t in RUNGS}
    for count, (truth, rgb) in enumerate(pictures.items(), start=6):  # numbers may differ
        for path in (own / f"own/{CASE}").glob("*.exr" if truth == "global" else f"{truth}/*"):
            path.unlink()
        for number in range(count):
            noisy = np.maximum(rgb * (1 + rng.normal(0, 0.02, rgb.shape)), 0)
            save_frame(Frame(noisy.astype(np.float32)), own / f"own/{CASE}/{truth}/{number}.exr")
    save_frame(Frame(pictures[drawn]), own / f"mine/{CASE}.exr")
    found = compared(shadeproof, own, "--candidate", own / "mine")
    assert len(found.ladders) == len({r.object for r in found.rows})
    for told in found.ladders:
        assert told.closes and told.total.diffuse is None
        assert [c.name for c in told.causes] == ["integration", "occlusion", "interreflection"]
        lacked = {name: f.value for name, f in told.missing.items()}
        if told.object != "sphere":  # which little stands around
            assert lacked["occlusion"] == pytest.approx(occlusion, abs=0.15)
            assert lacked["interreflection"] == pytest.approx(interreflection, abs=0.15)


def test_too_few_batches_are_told_beside_every_row(shadeproof, own):
    for number in range(2, 8):
        (own / f"own/{CASE}/{number}.exr").unlink()
    for row in compared(shadeproof, own, "--candidate", own / "mine").rows:
        assert "2 of the 8 batches that a reference needs" in row.note


def test_a_bad_truth_is_told_before_anything_is_drawn_and_leaves_what_is_there(shadeproof, own):
    compared(shadeproof, own, "--candidate", own / "mine")
    before = {p: p.stat().st_mtime_ns for p in sorted((own / "out").rglob("*"))}
    (own / f"own/{CASE}/7.exr").write_text("no")
    words = ("--suite", "tiny", "--truth", own / "own", "--out", own / "out")
    code, _, err = shadeproof("compare", *words, "--candidate", "false {case} {out}")
    assert code == 2 and "7.exr" in err and "candidate" not in err
    assert before == {p: p.stat().st_mtime_ns for p in sorted((own / "out").rglob("*"))}


BUDGETS = """
[[budget]]
technique = "candidate"
truth = "{truth}"
energy_error = 0.5
"""


@pytest.mark.parametrize(("truth", "code"), [("global", 0), ("direct", 1)])
def test_a_gate_fails_where_a_truth_with_a_budget_is_missing(shadeproof, own, truth, code):
    (own / "s.toml").write_text(small_suite(["global", "direct"]) + BUDGETS.format(truth=truth))
    words = ("--suite", own / "s.toml", "--truth", own / "own", "--candidate", own / "mine")
    assert shadeproof("gate", *words, "--out", own / "out")[0] == code
    missing = load_results(own / "out/results.json").missing
    assert {m.truth for m in missing} == ({"direct"} if code else set())


def test_a_folder_that_is_named_like_no_truth_is_refused(shadeproof, own):
    (own / f"own/{CASE}/Direct").mkdir()
    code, _, err = shadeproof("compare", "--suite", "tiny", "--truth", own / "own", "--dry-run")
    assert code == 2 and "Direct: is named like no truth; call it one of" in err


def test_batches_of_one_seed_are_refused(shadeproof, own):
    for number in (3, 6):
        save_frame(load_frame(own / f"own/{CASE}/0.exr"), own / f"own/{CASE}/{number}.exr")
    words = ("--suite", "tiny", "--truth", own / "own", "--candidate", own / "mine")
    code, _, err = shadeproof("compare", *words, "--out", own / "out")
    assert code == 2 and "3.exr" in err and "holds the same picture as 0.exr" in err


def test_an_even_surface_that_is_right_is_measured(shadeproof, own):
    """A white surface under even light has one value, and its truth has noise."""
    rng = np.random.default_rng(2)
    shape = load_frame(own / f"mine/{CASE}.exr").rgb.shape
    for number in range(8):
        noisy = 0.5 * (1 + rng.normal(0, 0.02, shape)).astype(np.float32)
        save_frame(Frame(noisy), own / f"own/{CASE}/{number}.exr")
    save_frame(Frame(np.full(shape, 0.5, np.float32)), own / f"mine/{CASE}.exr")
    for row in compared(shadeproof, own, "--candidate", own / "mine").rows:
        assert not row.problem and abs(row.energy_error) < 0.005


def test_a_folder_that_is_not_there_is_refused(shadeproof, tmp_path):
    code, _, err = shadeproof("compare", "--suite", "tiny", "--truth", tmp_path / "no")
    assert code == 2 and "no such folder" in err


def test_a_dry_run_tells_how_many_batches_there_are(shadeproof, own):
    words = ("--suite", "tiny", "--truth", own / "own", "--dry-run")
    code, out, _ = shadeproof("compare", *words, "--out", own / "out")
    assert code == 0 and f"global: 8 batches in {own / 'own'}" in out


def alone(own, *words):
    """What the command says without either renderer: exit code, stdout, stderr."""
    command = [sys.executable, "-c", ALONE, *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=own)
    return done.returncode, done.stdout, done.stderr


def test_the_comparison_needs_neither_opengl_nor_mitsuba(shadeproof, own):
    words = ["--suite", "tiny", "--truth", own / "own", "--candidate", own / "mine", "--out"]
    code, out, err = alone(own, "compare", *words, own / "alone")
    assert code == 0, out + err
    found = load_results(own / "alone/results.json")
    assert "device" not in found.provenance and (own / "alone/report.html").is_file()
    same = compared(shadeproof, own, "--candidate", own / "mine")
    assert [r.energy_local for r in found.rows] == [r.energy_local for r in same.rows]


@pytest.mark.parametrize(
    ("words", "extra"),
    [(("compare",), "renderer"), (("references",), "reference")],
)
def test_what_draws_or_traces_names_the_extra_that_it_needs(own, words, extra):
    code, _, err = alone(own, *words, "--suite", "tiny", "--store", own / "none")
    *_, last = err.strip().splitlines()
    assert code == 2 and "Traceback" not in err
    assert last.startswith("error: package") and f"shadeproof[{extra}]" in last
    assert ("or give" in last) == (words == ("compare",))


def test_cases_are_exported_without_the_path_tracer(own):
    code, out, err = alone(own, "export", "--suite", "tiny", "--to", own / "zips")
    assert code == 0, err
    assert "no Mitsuba XML" in out and (own / f"zips/{CASE}.zip").is_file()
