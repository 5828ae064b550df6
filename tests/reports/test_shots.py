"""Against each truth stands the picture with the switches that the truth has, drawn once."""

import pytest
import trimesh

from renderer.draw import REPEATS
from renderer.techniques import technique
from reports.candidates import Folder
from reports.gate import judged_against
from reports.ladder import MODEL_STEPS, RUNGS
from reports.progress import reporting
from reports.run.case import run_entry
from reports.run.job import Job
from reports.run.makers import Makers
from reports.run.shots import drawn_model, shots
from scenes.errors import InputError
from scenes.schema import PAPER, PHYSICAL, model_steps
from scenes.suite import expand, load_suite
from tests.reports.small import small_suite

TRUTHS = (*RUNGS, "physical-smith")


@pytest.fixture
def case():
    (entry,) = expand(*load_suite("tiny"))
    return entry.case


def names(label, case, truths=TRUTHS):
    return [shot.name for shot in shots(label, case, truths, timed=False).values()]


@pytest.mark.parametrize("label", ["paper", "paper-noaa", "split", "sampled", "filtered@8"])
def test_a_technique_without_switches_draws_one_picture_of_a_model(label, case):
    made = shots(label, case, RUNGS[:3], timed=True)
    assert names(label, case, RUNGS[:3]) == [label] * 3
    for shot in made.values():
        assert shot.case is case
        assert (shot.candidate.technique, shot.candidate.repeats) == (technique(label), REPEATS)


def test_a_technique_with_switches_draws_what_each_truth_has(case):
    assert names("best", case, RUNGS[:3]) == ["best.unoccluded", "best.direct", "best"]
    assert names("shadowed", case, RUNGS[:3]) == ["shadowed.unoccluded", "shadowed", "shadowed"]
    made = shots("best@8", case, TRUTHS, timed=False)
    on = [
        (s.candidate.technique.occlusion, s.candidate.technique.interreflection)
        for s in made.values()
    ]
    assert on == [(False, False), (True, False), (True, True), (True, True), (True, True)]
    assert {s.candidate.technique.samples for s in made.values()} == {8}


def test_who_can_draw_the_physical_model_does_so_where_the_truth_has_it(case):
    assert names("sampled", case) == [*["sampled"] * 3, *["sampled.physical"] * 2]
    assert names("best", case)[2:] == ["best", *["best.physical"] * 2]
    assert names("paper", case) == ["paper"] * 5
    made = shots("best", case, TRUTHS, timed=False)
    assert [s.case.model for s in made.values()] == [PAPER] * 3 + [PHYSICAL] * 2
    assert made["physical"].candidate.technique == technique("best")
    already = case.model_copy(update={"model": PHYSICAL})
    assert names("sampled", already) == ["sampled"] * 5


def test_on_the_way_to_the_physical_model_each_step_is_drawn(case):
    between = MODEL_STEPS[:-1]
    assert names("sampled", case, between) == ["sampled.Fresnel", "sampled.kd"]
    base = technique("sampled")
    assert [drawn_model(base, PAPER, t) for t in between] == model_steps(PAPER)[:2]
    # A step that changes nothing is no picture of its own.
    exact = case.model_copy(update={"model": model_steps(PAPER)[0]})
    assert names("sampled", exact, between) == ["sampled", "sampled.kd"]
    smith = PAPER.model_copy(update={"masking": "smith"})
    assert names("sampled", case.model_copy(update={"model": smith}), between)[1] == (
        "sampled.physical"
    )


def test_only_a_picture_of_the_physical_model_is_judged_against_it():
    assert judged_against("global", PAPER) and judged_against("physical", PHYSICAL)
    assert not judged_against("physical", PAPER)
    assert not judged_against("physical-smith", PHYSICAL)


def budgeted(tmp_path, label, truth):
    """A job whose one rule holds a technique against a truth."""
    rule = f'technique = "{label}"\ntruth = "{truth}"\nenergy_error = 0.5'
    text = small_suite(TRUTHS).replace('["paper"]', '["paper", "sampled"]')
    (tmp_path / "s.toml").write_text(f"{text}\n[[budget]]\n{rule}\n")
    return Job(str(tmp_path / "s.toml"), tmp_path / "out", tmp_path / "store")


def test_a_budget_against_physical_holds_where_that_model_is_drawn(tmp_path):
    assert budgeted(tmp_path, "sampled", "physical").family == 3  # objects, at one look


@pytest.mark.parametrize(
    ("label", "truth"),
    [("paper", "physical"), ("candidate", "physical"), ("sampled", "physical-smith")],
)
def test_a_budget_against_another_model_is_refused(tmp_path, label, truth):
    with pytest.raises(InputError, match=f"`{label}` draws another model than `{truth}`"):
        budgeted(tmp_path, label, truth)


OWN_MODEL = """
[[run]]
scene = "contact"
environments = ["sunset"]
model = { fresnel = "exact", kd = "interface", masking = "smith" }
"""


def test_only_verdicts_that_are_given_must_hold_together(tmp_path):
    """Of an outside candidate's two cases one has the physical model, and three objects."""
    rule = '[[budget]]\ntechnique = "candidate"\ntruth = "physical"\nenergy_error = 0.5\n'
    (tmp_path / "s.toml").write_text(f"{small_suite(TRUTHS)}{OWN_MODEL}{rule}")
    outside = Folder(tmp_path)
    job = Job(str(tmp_path / "s.toml"), tmp_path / "out", tmp_path / "store", outside=outside)
    assert len(job.entries) == 2 and job.family == 3


TOUCHING = """
description = "Two spheres that touch."
resolution = [64, 64]
[camera]
origin = [0.0, -7.0, 0.0]
target = [0.0, 0.0, 0.0]
fov = 33.0
[[object]]
name = "left"
mesh = "round.ply"
material = "copper"
position = [-1.0, 0.0, 0.0]
small = "a test"
[[object]]
name = "right"
mesh = "round.ply"
material = "red_plastic"
position = [1.0, 0.0, 0.0]
small = "a test"
"""


@pytest.fixture(scope="module")
def touching(tmp_path_factory):
    """Two techniques' record, rows and ladders of two spheres that touch."""
    folder = tmp_path_factory.mktemp("touching")
    (folder / "touching.toml").write_text(TOUCHING)
    trimesh.creation.icosphere(subdivisions=2).export(folder / "round.ply", vertex_normal=True)
    text = small_suite(RUNGS[:3], samples=36, most=288, size=(64, 64))
    text = text.replace('["paper"]', '["paper", "best"]').replace('"contact"', '"touching.toml"')
    (folder / "s.toml").write_text(text.replace("studio", "courtyard"))
    job = Job(str(folder / "s.toml"), folder / "out", folder / "store")
    return run(job)


def run(job):
    from reports import parity

    with reporting(20) as report:
        return run_entry(job, job.entries[0], report, parity.Checks(), Makers())


def of(ladders, label, name):
    (found,) = (f for f in ladders if (f.technique, f.object) == (label, name))
    return found, {c.name: c for c in found.causes if not c.parent}


def test_rows_say_which_picture_was_measured(touching):
    record, rows, _ = touching
    told = {(r.technique, r.truth): r.picture for r in rows}
    assert told == {
        **{("paper", t): "paper" for t in RUNGS[:3]},
        ("best", "unoccluded"): "best.unoccluded",
        ("best", "direct"): "best.direct",
        ("best", "global"): "best",
    }
    assert set(record.candidates) == set(told.values())


@pytest.mark.parametrize("name", ["left", "right"])
def test_the_best_technique_is_less_wrong_by_what_it_draws(touching, name):
    _, rows, ladders = touching
    (paper, before), (best, after) = (of(ladders, label, name) for label in ("paper", "best"))
    assert (paper.switched, best.switched) == ([], ["occlusion", "interreflection"])
    for cause in best.switched:
        assert abs(after[cause].energy.value) < 0.3 * abs(before[cause].energy.value), cause
        assert abs(best.missing[cause].value) < 0.3, cause
    assert best.closes and paper.closes
    for found, causes in ((paper, before), (best, after)):
        for figure in ("energy", "local"):
            summed = sum(getattr(c, figure).value for c in causes.values())
            gap = getattr(found, f"{figure}_gap")
            total = getattr(found.total, figure).value
            assert summed - total == pytest.approx(gap.value, abs=1e-9)
    errors = {r.technique: r.energy_local for r in rows if (r.object, r.truth) == (name, "global")}
    assert errors["best"] < 0.5 * errors["paper"]
