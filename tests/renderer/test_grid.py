"""Finer coverage where triangles are smaller than pixels: when, and that it loses nothing."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import trimesh

import renderer.techniques as techniques
from renderer.draw import Renderer
from renderer.grid import MOST_SAMPLES, grid_of
from renderer.probe import probe
from renderer.techniques import technique
from renderer.view import view
from scenes.schema import Camera, Material
from scenes.suite import HERE

SILVER = Material(roughness=0.1, metallic=1.0, metal="Ag")
WHITE = Material(roughness=0.1, metallic=1.0, metal=[1.0, 1.0, 1.0])
BUNNY = str(HERE / "meshes" / "bunny.ply")


def grid(case, most=4, scale=1):
    size = (case.width * scale, case.height * scale)
    return grid_of(case.objects, view(case), size, most, 4)


def test_the_smaller_the_triangles_the_finer_the_grid(light, make_case):
    path = light(1.0)
    near = make_case(path, (BUNNY, SILVER, {"height": 1.0}), size=(120, 90))
    grids = [grid(near, scale=k) for k in (1, 2, 4, 8, 16)]
    assert grids == sorted(grids, reverse=True)
    assert grids[0] == 4 and grids[-1] == 1
    assert grid(near, most=2) == 2
    assert grid(make_case(path, ("plane", SILVER, {}))) == 1


def test_the_smallest_triangles_of_all_objects_count_and_their_scale(light, make_case):
    plane, bunny = ("plane", SILVER, {}), (BUNNY, SILVER, {"height": 1.0})
    assert grid(make_case(light(1.0), plane, bunny)) == 4
    flat = (BUNNY, SILVER, {"scale": [400.0, 400.0, 1e-3]})
    assert grid(make_case(light(1.0), flat)) == 1  # by area in space, not by the mesh's own


def test_what_lies_behind_the_eye_asks_for_nothing(light, make_case):
    behind = (BUNNY, SILVER, {"height": 1.0, "position": (0.0, -9.0, 0.0)})
    assert grid(make_case(light(1.0), ("plane", SILVER, {}), behind)) == 1


def test_a_large_picture_stays_within_memory(light, make_case):
    dense = make_case(light(1.0), (BUNNY, SILVER, {"scale": 200.0, "position": (0, 0, -20)}))
    cloud = make_case(light(1.0), (BUNNY, SILVER, {"height": 1.0}), size=(4000, 3000))
    for case in (dense, cloud):
        assert grid(case, most=64) ** 2 * case.width * case.height * 4 <= 4 * MOST_SAMPLES


def test_a_mirror_of_fine_ripples_nears_what_whole_pixels_give(make_case):
    """A silver bunny of 60 pixels, beside 8 x 8 pixels a pixel."""
    sky = HERE / "environments" / "courtyard.exr"
    camera = Camera(origin=(0, -4, 0.6), target=(0, 0, 0.5), fov=20)
    case = make_case(sky, (BUNNY, SILVER, {"height": 1.0}), size=(64, 64), camera=camera)

    def drawn(**changed):
        how = replace(technique("filtered"), **changed)
        return Renderer(how, repeats=0).render(case)

    true = drawn(supersample=8, samples=4096, grid=1)
    inside = true.ids > 0

    def off(frame):
        return np.abs(frame.rgb - true.rgb)[inside].mean() / true.rgb[inside].mean()

    assert off(drawn()) < 0.5 * off(drawn(grid=1))
    assert drawn().rgb[inside].mean() == pytest.approx(true.rgb[inside].mean(), rel=0.02)


def test_even_light_stays_even_however_normals_turn(light, make_case):
    case = make_case(light(1.0), (BUNNY, WHITE, {"height": 1.0}), size=(48, 48))
    frame = Renderer(technique("filtered"), repeats=0).render(case)
    inside = frame.ids > 0
    assert frame.rgb[inside].mean() == pytest.approx(1, abs=0.01)


def test_shares_of_a_pixel_add_up_however_fine_the_grid(light, make_case):
    """A white square, seen aslant, that vanishes in its surroundings."""
    square = ("plane", WHITE, {"rotate": (90.0, 0.0, 0.0), "scale": 0.6})
    camera = Camera(origin=(0, -4, 0), target=(0, 0, 0), fov=40, up=(0.13, 0, 1))
    case = make_case(light(1.0), square, (BUNNY, WHITE, {"height": 1e-4}), camera=camera)
    dark = make_case(light(0.0), square, (BUNNY, WHITE, {"height": 1e-4}), camera=camera)
    for parts in (1, 2, 4):
        how = replace(technique("filtered"), grid=parts)
        shown = Renderer(how, repeats=0).render(case).rgb
        assert shown == pytest.approx(np.ones_like(shown), abs=0.02)  # shares add up to 1
        assert Renderer(how, repeats=0).render(dark).rgb.max() == 0


@pytest.fixture
def ball(tmp_path):
    """A unit ball of fewer triangles than the primitive, quicker to bake."""
    trimesh.creation.icosphere(subdivisions=4).export(tmp_path / "b.ply", vertex_normal=True)
    return str(tmp_path / "b.ply")


def test_a_picture_in_turns_is_the_picture(monkeypatch, light, make_case, ball):
    sky = np.random.default_rng(2).random((16, 32, 3))
    pair = [(ball, SILVER, {"position": (x, 0.0, 0.0), "scale": 0.5}) for x in (-0.6, 0.6)]
    case = make_case(light(sky), *pair, size=(32, 24))
    how = technique("best")
    assert grid(case) == 4
    monkeypatch.setattr(techniques.Technique, "least_points", lambda *_: 4)  # for either
    in_turns = Renderer(how, repeats=0).render(case).rgb
    assert replace(how, grid=4).turns(SILVER) == 4
    monkeypatch.setattr(techniques, "PASS_RAYS", 1 << 10)
    assert replace(how, grid=4).turns(SILVER) == 1
    at_once = Renderer(how, repeats=0).render(case).rgb
    np.testing.assert_allclose(in_turns, at_once, rtol=1e-5, atol=1e-7)


def passes(how, material, points):
    """The shading points of each pass, of a pixel that has so many: as surface_shade.frag does."""
    turns = how.turns(material)
    ends = [-(-k * points // turns) for k in range(turns + 1)]
    return [range(a, b) for a, b in pairwise(ends)]


def test_turns_hold_every_shading_point_once_and_few_rays():
    for name in ("paper", "filtered", "best", "best@16", "best@300"):
        for parts in (1, 2, 4):
            for roughness in (0.05, 0.1, 0.17, 0.3, 0.5):
                how = replace(technique(name), grid=parts)
                metal = SILVER.model_copy(update={"roughness": roughness})
                points = how.least_points(metal)
                while points <= how.points:
                    told = passes(how, metal, points)
                    assert [i for one in told for i in one] == list(range(points))
                    if how.traces(metal):
                        rays = max(len(one) for one in told) * how.per_point(metal, points)
                        assert rays <= techniques.PASS_RAYS
                        fewest = min(how.coverage, how.samples, techniques.FEWEST_RAYS)
                        assert how.per_point(metal, points) * points >= fewest
                    points *= techniques.GROUP


def test_a_pixel_is_shaded_in_as_few_points_as_its_normals_ask(monkeypatch, light, make_case):
    """Of a rough ball a few pixels across, groups of samples tell what single samples do."""
    sky = np.linspace(0.1, 1, 16)[:, None, None] * np.ones((16, 32, 3))
    rough = SILVER.model_copy(update={"roughness": 0.5})
    case = make_case(light(sky), ("sphere", rough, {"scale": 0.5}), size=(24, 24))
    how = technique("filtered")
    assert grid(case) == 4
    grouped = Renderer(how, repeats=0).render(case)
    monkeypatch.setattr(techniques.Technique, "grouped", False)
    each = Renderer(how, repeats=0).render(case).rgb
    off = (grouped.rgb - each)[grouped.ids > 0] / each.mean()
    assert 1e-6 < np.abs(off).mean() < 0.007


def test_smooth_plastic_balls_shade_each_other_as_rough_ones_do(light, make_case, ball):
    """The diffuse lobe of a smooth dielectric sends rays of its own, however few a pixel has."""
    shown = {}
    for roughness in (0.1, 0.6):
        white = Material(albedo=(0.8,) * 3, f0=0.02, roughness=roughness, metallic=0.0)
        balls = [(ball, white, {"scale": 0.5, "position": (x, 0, 0)}) for x in (-1, 0)]
        case = make_case(light(1.0), *balls)
        frame = Renderer(technique("shadowed"), repeats=0).render(case)
        shown[roughness] = frame.rgb[frame.ids == 2]
    smooth, rough = (np.percentile(x, 10) for x in shown.values())
    assert smooth == pytest.approx(rough, rel=0.06)
    assert rough < 0.8


@pytest.mark.parametrize("sets", [1, 4, 16, 64])
@pytest.mark.parametrize("count", [1, 4])
def test_the_sets_of_a_pixel_share_the_disc_and_neighbours_lie_apart(sets, count):
    i, s = (x.reshape(-1) for x in np.meshgrid(np.arange(count), np.arange(sets)))
    found = probe(
        f"vec4(spiral(int(a.x), {count}, int(a.y), {sets}), 0.0, 0.0)",
        {"a": np.stack([i, s], axis=1).astype(np.float32)},
        ("spiral.glsl",),
    )[:, :2]
    rings = np.sort(found[:, 0])
    np.testing.assert_allclose(rings, (np.arange(count * sets) + 0.5) / (count * sets), atol=1e-6)
    first = found[i == 0, 0] * count
    if sets > 4:
        assert np.abs(np.diff(first)).min() > 0.2
