"""The doctor names each planted mistake, alone and together, and none where there is none."""

import math
from pathlib import Path

import numpy as np
import pytest

from renderer.draw import Renderer
from renderer.techniques import technique
from reports.candidates import CandidateError
from reports.doctor.mistakes import MISTAKES, gained, turned
from reports.doctor.scenes import CASES, doctor_cases
from reports.doctor.told import sentences
from reports.run.doctor import examine, write_cases
from scenes.frame import Frame, save_frame
from scenes.schema import Case


class Planted:
    """One of our own techniques, with mistakes."""

    def __init__(self, folder: Path, *mistakes, name="paper"):
        self.folder, self.mistakes = folder, mistakes
        self.renderer = Renderer(technique(name), repeats=0)

    def render(self, case: Case) -> Frame:
        for mistake in self.mistakes:
            case = mistake.case(case, self.folder)
        rgb = self.renderer.render(case).rgb
        for mistake in sorted(self.mistakes, key=lambda m: m.order):
            rgb = mistake.picture(rgb)
        return Frame(np.ascontiguousarray(rgb))


def words(*mistakes):
    return {m.words for m in mistakes}


@pytest.mark.parametrize("name", ["paper", "paper-noaa", "sampled", "split"])
def test_an_honest_renderer_is_sound(tmp_path, name):
    """The paper's smears small suns; that is what the comparison measures, and no mistake."""
    found = examine(Planted(tmp_path, name=name))
    assert found.sound and sentences(found)[0].startswith("nothing wrong")


def mistake(part):
    """The mistake that is told in words with this part."""
    (found,) = [m for m in MISTAKES if part in m.words]
    return found


TEN = (
    *(m for m in MISTAKES if m.kind != "turn" or "90" in m.words),
    gained(math.pi, ": pi, which the diffuse lobe is to be divided by"),
    gained(1 / math.pi, ": by pi, divided by once too often"),
)
SOON = ("v flipped", "sRGB", "faceted")


@pytest.mark.parametrize(
    "planted",
    [
        m if any(w in m.words for w in SOON) else pytest.param(m, marks=pytest.mark.long)
        for m in TEN
    ],
    ids=lambda m: m.words,
)
def test_each_planted_mistake_is_named_alone(tmp_path, planted):
    found = examine(Planted(tmp_path, planted))
    assert words(*found.found) == words(planted)
    assert not found.sound and planted.remedy in sentences(found)[0]


def test_there_are_more_than_ten():
    assert len(TEN) >= 16 and len(words(*TEN)) == len(TEN)


@pytest.mark.long
def test_any_turn_is_told_in_steps_of_15_degrees(tmp_path):
    assert words(*examine(Planted(tmp_path, turned(135.0))).found) == words(turned(135.0))


@pytest.mark.long
def test_any_gain_is_told_as_a_number(tmp_path):
    (found,) = examine(Planted(tmp_path, gained(2.2))).found
    assert (found.kind == "gain" and "2.1" in found.words) or "2.2" in found.words


@pytest.mark.long
def test_mistakes_are_told_together(tmp_path):
    turn, flip, encoded = turned(90.0), mistake("v flipped"), mistake("sRGB")
    assert words(*examine(Planted(tmp_path, turn, encoded)).found) == words(turn, encoded)
    assert words(*examine(Planted(tmp_path, turn, flip)).found) == words(turn, flip)


class Odd:
    """A renderer that does what no mistake here explains."""

    def __init__(self, change):
        self.change, self.renderer = change, Renderer(technique("paper"), repeats=0)

    def render(self, case: Case) -> Frame:
        return Frame(self.change(self.renderer.render(case).rgb.copy()))


def test_what_nobody_knows_is_not_called_sound():
    def squares(rgb):
        rgb[:, ::8] = 0
        return rgb

    found = examine(Odd(squares))
    assert not found.sound and not found.explained
    assert "none of the mistakes known here" in sentences(found)[-1]


@pytest.mark.parametrize(
    ("value", "told"),
    [(np.nan, "NaN or Inf in 1 of"), (-1.0, "below zero in 1 of"), (None, "is black")],
)
def test_pictures_that_are_none_are_told(value, told):
    def spoil(rgb):
        if value is None:
            return 0 * rgb
        rgb[0, 0] = value
        return rgb

    found = examine(Odd(spoil))
    assert not found.sound and all(told in line for line in sentences(found)[: len(CASES)])
    assert "doctor --cases" in sentences(found)[-1]


def test_a_candidate_that_draws_nothing_is_told():
    class Broken:
        def render(self, case):
            raise CandidateError("exit code 1")

    found = examine(Broken())
    assert not found.sound and sentences(found)[0] == "doctor.mirror: exit code 1"


def test_cases_go_to_a_folder_and_pictures_come_from_one(shadeproof, tmp_path):
    paths = write_cases(tmp_path / "cases")
    cases = [Case.model_validate_json(p.read_text()) for p in paths]
    assert [c.id for c in cases] == [f"doctor.{n}" for n in CASES]
    (tmp_path / "mine").mkdir()
    for case in cases:
        frame = Renderer(technique("filtered"), repeats=0).render(case)
        save_frame(Frame(frame.rgb), tmp_path / "mine" / f"{case.id}.exr")
    code, out, err = shadeproof("doctor", "--candidate", tmp_path / "mine")
    assert code == 0 and "nothing wrong" in out, out + err
    (tmp_path / "mine/doctor.sun.exr").unlink()
    code, out, _ = shadeproof("doctor", "--candidate", tmp_path / "mine")
    assert code == 1 and "doctor.sun" in out


def test_one_of_candidate_and_cases_has_to_be_given(shadeproof):
    assert shadeproof("doctor")[0] == 2


def test_nothing_in_the_cases_is_symmetric(tmp_path):
    """Each flip, mirror and exchange changes what is seen."""
    for case in doctor_cases(tmp_path).values():
        rgb = Renderer(technique("filtered"), repeats=0).render(case).rgb
        for other in (rgb[::-1], rgb[:, ::-1]):
            assert np.abs(rgb - other).max() > 0.1
