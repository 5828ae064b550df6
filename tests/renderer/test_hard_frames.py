"""Whole pictures of hard inputs hold what they must, and a picture that does not is told."""

from dataclasses import replace

import numpy as np
import pytest

from reports.run.stability import frames
from reports.stability.hard import hard_cases
from reports.stability.hard.case import QUICK, TECHNIQUES, off
from reports.stability.hard.inputs import COPPER, under_sky

SOON = (
    "furnace",
    "black",
    "sun-1e+06",
    "bright-column-on-the-seam",
    "negatives",
    "constant-511x255",
    "texel-3.40282e+38",
    "light-doubled",
    "zero-area-triangles",
    "normals-nan",
    "normals-opposed",
    "normals-turned-away",
    "1e6-away-by-file",
    "camera-inside",
    "camera-at-a-vertex",
    "object-across-the-near-plane",
    "object-outside",
    "object-1e-16",
    "coincident-surfaces",
    "1x1-pixels",
    "7x13-pixels",
    "sun-in-a-mirror",
    "drawn-twice",
    "split-frame",
    "mirrored-scene",
    "everything-turned",
    "roughness-0-paper",
    "roughness-0.01-smith",
    "weight-1e-07-is-0",
    "F0-0",
    "F0-out-of-gamut",
)
# With `best` too, which bakes each scene: of each kind one, two of them in the long tests.
BAKED = ("normals-nan", "7x13-pixels")
LATER = ("sun-1e+06", "roughness-0.01-smith")
CASES = [n if n in SOON else pytest.param(n, marks=pytest.mark.long) for n in hard_cases()]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("hard")


@pytest.mark.parametrize("name", CASES)
def test_what_must_hold_of_a_hard_case_holds(folder, name):
    techniques = TECHNIQUES if name in BAKED or name not in SOON else QUICK
    found = frames.measure(hard_cases()[name], folder, techniques)
    assert found.passed, found.measured
    assert found.command == f"shadeproof stability --hard {name}"


@pytest.mark.long
@pytest.mark.parametrize("name", LATER)
def test_what_is_baked_holds_too(folder, name):
    assert frames.measure(hard_cases()[name], folder, ("best",)).passed


def test_every_kind_of_case_is_tried_soon():
    cases = hard_cases()
    assert set(SOON) <= set(cases)
    assert {cases[n].kind for n in SOON} == {"environment", "mesh", "image", "material"}


@pytest.fixture
def drawn(monkeypatch, folder):
    """Measure a hard case whose pictures by one technique are changed before they are judged."""

    def measure(name: str, change, technique: str = "paper"):
        draw = frames._draw

        def changed(how, case, part=None):
            frame = draw(how, case, part)
            return replace(frame, rgb=change(frame.rgb.copy())) if how == technique else frame

        monkeypatch.setattr(frames, "_draw", changed)
        return frames.measure(hard_cases()[name], folder, (technique,))

    return measure


@pytest.mark.parametrize("technique", TECHNIQUES)
@pytest.mark.parametrize("value", [np.nan, np.inf, -1e-30])
def test_one_unfit_pixel_of_any_technique_fails_a_case(drawn, technique, value):
    def spoil(rgb):
        rgb[0, 0, 1] = value
        return rgb

    found = drawn("1x37-pixels", spoil, technique)
    assert not found.passed and found.measured["pixels NaN, Inf or negative"] == 1


@pytest.mark.parametrize(
    ("name", "technique"), [("furnace", "paper"), ("black", "sampled"), ("camera-inside", "paper")]
)
def test_light_from_nowhere_fails_a_case(drawn, name, technique):
    assert not drawn(name, lambda rgb: rgb + 0.3, technique).passed


def test_a_picture_that_is_clipped_fails_the_sun(drawn):
    assert not drawn("sun-in-a-mirror", lambda rgb: np.minimum(rgb, 65504)).passed


def test_what_should_be_refused_and_is_drawn_fails(folder):
    row = replace(hard_cases()["object-1e-16"], case=under_sky(("sphere", COPPER, {})))
    assert not frames.measure(row, folder).passed


def test_a_wrong_silhouette_fails_a_case(monkeypatch, folder):
    draw = frames._draw

    def moved(how, case, part=None):
        frame = draw(how, case, part)
        return replace(frame, ids=np.roll(frame.ids, 1, axis=1))

    row = replace(hard_cases()["zero-area-triangles"], expect=None)
    assert frames.measure(row, folder).passed
    monkeypatch.setattr(frames, "_draw", moved)
    assert not frames.measure(row, folder).passed


def test_each_pixel_counts_by_its_own_brightness():
    bright = np.ones((4, 4, 3))
    bright[0, 0] = 1e9
    wrong = bright.copy()
    wrong[3, 3] = 2
    everywhere = np.ones((4, 4), bool)
    assert off(wrong, bright, everywhere)[0] == pytest.approx(np.sqrt(1 / 16))
    assert off(wrong, bright, everywhere)[1] == 1
    assert off(bright, bright, everywhere) == (0, 0)
    assert off(np.full((4, 4, 3), np.nan), bright, everywhere)[0] == np.inf
    assert off(wrong, bright, np.zeros((4, 4), bool)) == (0, 0)


@pytest.mark.parametrize("name", ["furnace", "mirrored-scene", "sun-1e+09-energy"])
def test_a_renderer_that_shows_no_object_fails_the_case(monkeypatch, folder, name):
    draw = frames._draw

    def lost(*given):
        frame = draw(*given)
        return replace(frame, ids=np.zeros_like(frame.ids))

    monkeypatch.setattr(frames, "_draw", lost)
    assert not frames.measure(hard_cases()[name], folder, ("paper",)).passed


def test_an_unknown_case_is_refused_with_those_that_are_known(refused):
    refused(lambda: frames.hard_frames(["soft"]), "--hard", "'soft'", "--list")
