"""Whole pictures of what surfaces do to one another's light."""

from dataclasses import replace

import numpy as np
import pytest

from renderer.draw import Renderer
from renderer.techniques import technique
from scenes.schema import Camera, Material, Model

WHITE = Material(albedo=(1.0, 1.0, 1.0), f0=0.0, roughness=0.5, metallic=0.0)
GREY = Material(albedo=(0.5, 0.5, 0.5), f0=0.0, roughness=0.5, metallic=0.0)
ABOVE = Camera(origin=(0, -4, 4), target=(0, 0, 0), fov=40)


@pytest.mark.parametrize("metallic", [0.0, 1.0])
def test_a_white_bowl_in_a_furnace_vanishes(light, make_case, bowl, metallic):
    """Light that the bowl keeps from itself it gives back to itself: nothing of it is lost."""
    white = Material(
        albedo=(1.0, 1.0, 1.0), roughness=0.7, metallic=metallic, metal=[1.0, 1.0, 1.0]
    )
    case = make_case(light(1.0), (bowl, white, {}), camera=ABOVE, size=(96, 72))
    whole = Model(masking="smith", kd="conserving", multiscatter="on")
    case = case.model_copy(update={"model": whole})
    shown = {
        n: Renderer(technique(n), repeats=0).render(case) for n in ("filtered", "shadowed", "best")
    }
    seen = shown["best"].ids > 0
    assert shown["filtered"].rgb[seen].mean() == pytest.approx(1, abs=0.005)
    # Away from the rim, whose smoothed normals lean: what is sampled below the surface is black.
    deep = seen & (shown["shadowed"].rgb[..., 0] < 0.7)
    assert deep.sum() > 300
    assert shown["best"].rgb[deep].mean() == pytest.approx(1, abs=0.03)


def test_a_small_sun_casts_a_sharp_shadow(light, make_case):
    sky = np.full((256, 512, 3), 0.01)
    sky[30, 100] = 8e5
    ball = ("sphere", GREY, {"scale": 0.3, "position": (0, 0, 1.0)})
    plate = ("plane", WHITE, {"scale": 4.0})
    case = make_case(light(sky), ball, plate, camera=ABOVE, size=(192, 144))
    lit = Renderer(replace(technique("shadowed"), msaa=0), repeats=0).render(case)
    seen = lit.rgb[lit.ids == 2][:, 0]
    assert seen.min() < 0.05 * np.median(seen)
    between = (seen > 0.2 * np.median(seen)) & (seen < 0.8 * np.median(seen))
    assert between.sum() < 10 < (seen < 0.2 * np.median(seen)).sum()


@pytest.mark.parametrize("sun", [0.0, 1e4, 1e6])
@pytest.mark.parametrize("diffuse", [False, True])
def test_what_nothing_stands_around_is_drawn_as_without_occlusion(
    light, make_case, copper, diffuse, sun
):
    """A lone ball is convex: below its vertices' horizons alone is anything blocked."""
    sky = np.random.default_rng(0).uniform(0.5, 1.5, (16, 32, 3))
    sky = np.kron(sky, np.ones((8, 8, 1)))
    sky[40, 100] += sun
    case = make_case(light(sky), ("sphere", GREY if diffuse else copper(0.3, 0.5), {}))
    shown = [Renderer(technique(n), repeats=0).render(case) for n in ("filtered", "best")]
    bare, best = (s.rgb[s.ids > 0] for s in shown)
    # At the rim a part of the lobe lies between the pixel's horizon and the vertices'.
    assert np.sqrt(((best / bare - 1) ** 2).mean()) < 0.01


@pytest.mark.parametrize("name", ["shadowed", "best"])
def test_parts_show_what_the_whole_shows(ball_and_plate, name):
    renderer = Renderer(technique(name), repeats=0)
    whole = renderer.render(ball_and_plate)
    part = renderer.render(ball_and_plate, (20, 10, 30, 30))
    rows = slice(48 - 40, 48 - 10)
    np.testing.assert_array_equal(part.ids, whole.ids[rows, 20:50])
    off = part.rgb / whole.rgb[rows, 20:50] - 1
    assert np.sqrt((off**2).mean()) < 1e-4
