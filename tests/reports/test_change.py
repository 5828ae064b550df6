"""What changed between two runs: on the same references, figure by figure, and who is to blame."""

import json
import shutil

import numpy as np
import pytest

from reports.change.figures import TOLERANCES, moved
from reports.change.ranking import by_row, harm, verdict_of
from reports.change.runs import changes_between
from reports.change.since import since
from reports.change.told import counted, markdown, telling
from reports.metrics.subject import Subject, TruthView
from reports.results import CaseRecord, load_results, save_results
from scenes.frame import Frame, load_frame, save_frame
from tests.reports.pages import Page, results, row, written

SHAPE = (160, 320)
IDS = np.zeros(SHAPE, np.uint8)
IDS[16:144, 16:144], IDS[16:144, 176:304] = 1, 2
TRUTH = np.random.default_rng(1).uniform(0.3, 0.6, (*SHAPE, 3)).astype(np.float32)
NOISE = np.random.default_rng(2).normal(0, 0.02, (2, *SHAPE, 3)).astype(np.float32)


def run(folder, candidate, truth=TRUTH, rows=None, **fields):
    """A run of two objects in a folder, whose candidate is the truth times `candidate`."""
    folder.mkdir(exist_ok=True)
    shown = (TRUTH * np.broadcast_to(candidate, (*SHAPE, 3))).astype(np.float32)
    save_frame(Frame(shown), folder / "paper.exr")
    for name, noise in zip("ab", NOISE, strict=True):
        save_frame(Frame(truth * (1 + noise), IDS), folder / f"{name}.exr")
    rows = rows or [row(), row(object="right", weight=0.5)]
    case = CaseRecord(
        id="spheres.dusk", scene="spheres", environment="dusk", width=SHAPE[1], height=SHAPE[0],
        objects=["left", "right"], candidates={"paper": "paper.exr"},
        truths={"global": ("a.exr", "b.exr")},
    )  # fmt: skip
    made = results(rows, cases=[case], **fields)
    save_results(made, folder / "results.json")
    return made, folder / "results.json"


def changed(old, new):
    return changes_between(*old, *new)


def of(changes, thing):
    return {c.figure: c for c in changes.changes if c.object == thing}


def brighter(by, thing=1):
    return np.where(thing == IDS, 1 + by, 1.0)[..., None]


def test_the_same_pictures_change_nothing(tmp_path):
    found = changed(run(tmp_path / "old", 1.1), run(tmp_path / "new", 1.1))
    assert counted(found) == "2 unchanged" and not telling(found)
    assert all((c.change, c.low, c.high, c.paired) == (0, 0, 0, True) for c in found.changes)


def test_what_got_worse_is_told_by_how_much(tmp_path):
    found = changed(run(tmp_path / "old", brighter(0.1)), run(tmp_path / "new", brighter(0.15)))
    left, right = of(found, "left"), of(found, "right")
    assert {c.verdict for c in right.values()} == {"unchanged"}
    for figure in ("energy_error", "energy_local"):
        told = left[figure]
        assert told.verdict == "worse" and told.paired
        assert told.change == pytest.approx(0.05, abs=2e-3)
        assert told.low <= told.change <= told.high and told.high - told.low < 0.01
    assert left["flip"].verdict == "worse" and left["flip"].change > 0
    assert counted(found) == "1 worse, 1 unchanged"
    assert next(iter(by_row(found)))[1] == "left"


def test_what_got_better_is_told_whatever_its_sign(tmp_path):
    found = changed(run(tmp_path / "old", brighter(0.15)), run(tmp_path / "new", brighter(-0.05)))
    left = of(found, "left")
    assert verdict_of(left.values()) == "better"
    assert left["energy_error"].change == pytest.approx(-0.1, abs=2e-3)
    assert harm(left["energy_error"]) < 0


def test_less_ssim_is_worse(tmp_path):
    blurred = TRUTH.copy()
    blurred[1:-1] = (TRUTH[:-2] + TRUTH[1:-1] + TRUTH[2:]) / 3
    new = run(tmp_path / "new", blurred / TRUTH)
    found = of(changed(run(tmp_path / "old", 1.0), new), "left")
    assert found["ssim"].verdict == "worse" and found["ssim"].change < -0.05
    assert harm(found["ssim"]) > 0


def test_a_change_in_one_place_counts_and_its_interval_says_so(tmp_path):
    spot = np.ones((*SHAPE, 1))
    spot[36:60, 36:60] = 1.5  # in one of 25 blocks: drawn with replacement it may be left out
    found = of(changed(run(tmp_path / "old", 1.0), run(tmp_path / "new", spot)), "left")
    assert found["energy_error"].verdict == found["energy_local"].verdict == "worse"
    assert found["energy_error"].low <= 1e-4 < found["energy_error"].change


def test_a_small_object_is_judged_without_an_interval(tmp_path):
    mask = np.zeros((64, 64), bool)
    mask[20:24, 20:24] = True
    truth = TruthView(np.full((2, 64, 64, 3), 0.5, np.float32), mask, 0.4)
    old, new = (Subject(truth.mean * np.float32(f), truth) for f in (1.0, 0.1))
    found = {m.figure: m for m in moved(old, new)}
    assert found["energy_error"].change == pytest.approx(0.9) and np.isnan(
        found["energy_error"].low
    )
    thin = TruthView(truth.batches, mask & (np.arange(64) == 21), 0.4)
    figures = [m.figure for m in moved(Subject(old.candidate, thin), Subject(new.candidate, thin))]
    assert "ssim" not in figures and "energy_error" in figures


def test_intervals_hold_what_would_be_measured_of_other_blocks():
    """Changes that differ block by block about a mean: 95 % of the intervals hold it."""
    rng, held, mean = np.random.default_rng(3), 0, 0.05
    mask = np.ones((160, 160), bool)
    truth = TruthView(np.full((2, 160, 160, 3), 0.5, np.float32), mask, 0.4)
    for _ in range(60):
        gains = 1 + mean + rng.normal(0, 0.03, (5, 5))
        picture = 0.5 * np.kron(gains, np.ones((32, 32)))[..., None] * np.ones(3)
        old, new = (Subject(p.astype(np.float32), truth) for p in (truth.mean, picture))
        (found,) = [m for m in moved(old, new) if m.figure == "energy_error"]
        held += found.low <= mean <= found.high
    assert 50 <= held <= 60  # percentiles of 25 blocks are a little narrow


def test_the_references_noise_cancels(tmp_path):
    """The runs' own figures differ by their noise; the change does not."""
    found = of(changed(run(tmp_path / "old", 1.02), run(tmp_path / "new", 1.021)), "left")
    assert found["energy_error"].change == pytest.approx(1e-3, rel=0.02)
    assert found["energy_error"].high - found["energy_error"].low < 1e-4


def test_an_old_run_without_its_pictures_is_compared_by_its_figures(tmp_path):
    old, new = run(tmp_path / "old", 1.1), run(tmp_path / "new", 1.3)
    (tmp_path / "old/paper.exr").unlink()
    found = of(changed(old, new), "left")
    assert not any(c.paired for c in found.values())
    assert found["energy_error"].change == 0 and found["energy_error"].verdict == "unchanged"
    assert "paper.exr" in found["energy_error"].reason


def test_figures_of_two_references_have_the_noise_of_both(tmp_path):
    old = run(tmp_path / "old", 1.1)
    new = run(tmp_path / "new", 1.3, rows=[row(energy_error=0.0105, energy_ci95=(0.0095, 0.0115))])
    (tmp_path / "old/paper.exr").unlink()
    found = of(changed(old, new), "left")["energy_error"]
    reach = np.hypot(1e-3, 1e-3)
    assert (found.low, found.high) == pytest.approx((5e-4 - reach, 5e-4 + reach))
    assert found.verdict == "unclear"


@pytest.mark.parametrize("moved_ids", [True, False])
def test_another_scene_is_not_compared(tmp_path, moved_ids):
    old = run(tmp_path / "old", 1.0)
    new = run(tmp_path / "new", 1.0, truth=TRUTH * (1 if moved_ids else np.float32(1.2)))
    if moved_ids:
        for name in ("a.exr", "b.exr"):
            frame = load_frame(tmp_path / "new" / name)
            save_frame(Frame(frame.rgb, np.roll(IDS, 5, axis=1)), tmp_path / "new" / name)
    found = changed(old, new)
    assert not found.changes and len(found.incomparable) == 2
    assert "has changed" in found.incomparable[0].reason
    assert any("could not be compared" in r for r in judged(old, new).reasons)


def test_a_reference_that_grew_is_the_same(tmp_path, monkeypatch):
    old = run(tmp_path / "old", 1.1)
    monkeypatch.setattr("tests.reports.test_change.NOISE", NOISE[::-1] / 3)
    found = changed(old, run(tmp_path / "new", 1.1))
    assert counted(found) == "2 unchanged" and all(c.paired for c in found.changes)


def test_rows_that_only_one_run_has_are_named(tmp_path):
    old = run(tmp_path / "old", 1.0)
    new = run(tmp_path / "new", 1.0, rows=[row(), row(technique="split", picture="paper")])
    found = changed(old, new)
    reasons = {(i.object, i.technique): (i.reason, i.lost) for i in found.incomparable}
    assert reasons == {
        ("left", "split"): ("the old run does not have it", False),
        ("right", "paper"): ("the new run does not have it", True),
    }


def judged(old, new, **fields):
    """The new run as `gate --regression` judges it."""
    made, path = new
    return since(made.model_copy(update=fields), path.parent, *old, judged=True)


def test_worse_rows_fail_a_run_that_is_judged_by_an_earlier_one(tmp_path):
    old, new = run(tmp_path / "old", 1.0), run(tmp_path / "new", brighter(0.02))
    verdict = judged(
        old, new, rows=[r.model_copy(update={"verdict": "reported"}) for r in new[0].rows]
    )
    assert verdict.verdict == "fail"
    assert verdict.reasons[0].startswith("1 of 2 rows are worse than in")
    assert "spheres.dusk left (paper against global)" in verdict.reasons[0]
    same = judged(old, run(tmp_path / "same", 1.0))
    assert same.changed.judged and not [r for r in same.reasons if "worse" in r]


def test_a_row_that_is_gone_fails_unless_it_was_filtered_out(tmp_path):
    old, new = run(tmp_path / "old", 1.0), run(tmp_path / "new", 1.0, rows=[row()])
    assert any("are gone" in r for r in judged(old, new).reasons)
    skipped = ["spheres.dusk (filter 'noon')"]
    assert not any("are gone" in r for r in judged(old, new, skipped=skipped).reasons)


def test_nothing_in_common_fails(tmp_path):
    old = run(tmp_path / "old", 1.0)
    new = run(tmp_path / "new", 1.0, rows=[row(technique="split", picture="paper")])
    assert any("no row could be compared" in r for r in judged(old, new).reasons)


def test_the_page_shows_what_changed_and_links_to_it(tmp_path):
    old, new = run(tmp_path / "old", 1.0), run(tmp_path / "new", brighter(0.05))
    page = Page(written(judged(old, new), tmp_path / "new"))
    assert "1 worse, 1 unchanged" in page.text["section"]
    assert {"changed", "row--spheres.dusk--left--paper--global"} <= {
        a["href"][1:] for t, a in page.elements if t == "a"
    }


def test_the_summary_says_it_too(tmp_path):
    found = changed(run(tmp_path / "old", 1.0), run(tmp_path / "new", brighter(0.05)))
    text = "\n".join(markdown(found))
    assert "1 worse, 1 unchanged" in text and "| worse | spheres.dusk left" in text


def test_diff_on_the_command_line(shadeproof, tmp_path):
    run(tmp_path / "old", 1.0)
    run(tmp_path / "new", brighter(0.05))
    names = [tmp_path / name / "results.json" for name in ("old", "new")]
    code, out, _ = shadeproof("diff", *names)
    assert code == 0 and "1 worse, 1 unchanged" in out
    code, out, _ = shadeproof("diff", *names, "--json")
    assert code == 0 and {c["figure"] for c in json.loads(out)["changes"]} == set(TOLERANCES)


def test_a_gate_judges_by_an_earlier_run(shadeproof, tiny, tmp_path):
    """The same code passes without any budget; where the earlier run was right, it fails."""
    earlier = tmp_path / "earlier"
    shutil.copytree(tiny, earlier)
    asked = ("gate", "--suite", "tiny", "--regression", earlier / "results.json")
    code, out, err = shadeproof(*asked, "--out", tmp_path / "same")
    assert code == 0, out + err
    assert not load_results(tmp_path / "same/results.json").budgets
    truth = load_frame(earlier / "truths/contact.studio/global.a.exr")
    save_frame(truth, earlier / "frames/contact.studio/paper.exr")
    code, out, err = shadeproof(*asked, "--out", tmp_path / "worse")
    assert code == 1, out + err
    assert "rows are worse than in" in out and "picture: " in out and "see it: " in out
    assert (tmp_path / "worse/crops/1.png").is_file()
    assert "![" in (tmp_path / "worse/summary.md").read_text()
    assert "worse: " in (tmp_path / "worse/junit.xml").read_text()


def test_an_earlier_run_that_would_be_written_over_is_refused(shadeproof, tmp_path):
    run(tmp_path / "old", 1.0)
    code, _, err = shadeproof(
        "gate", "--suite", "tiny", "--regression", tmp_path / "old/results.json",
        "--out", tmp_path / "old",
    )  # fmt: skip
    assert code == 2 and "lies in --out, which this run writes over" in err
    assert (tmp_path / "old/paper.exr").is_file()
