"""Whole pictures: light, camera, environment and visibility, against what can be said by hand."""

import drjit as dr
import numpy as np
import OpenImageIO as oiio
import pytest
from scipy.ndimage import binary_dilation, binary_erosion

from reference import truths
from reference.scene_dict import build_scene, camera_rays
from reference.settings import PATH, kind_of, rounded_samples
from reference.truths import mi, stage
from scenes.schema import Camera, Environment, Material, Object
from tests.reference import formula
from tests.reference.cases import metal, plastic, project

BLACK = Material(albedo=(0, 0, 0), roughness=1, metallic=0, f0=0)
SIDE = Camera(origin=(1, -9, 2), target=(0.3, 0, 0.5), fov=30)


def test_a_smooth_perfect_mirror_in_uniform_light_cannot_be_seen(make_case):
    ready = stage(make_case(material=metal(roughness=0.1)), "model")
    picture = ready.trace(64, seed=1)["unoccluded"]
    # At alpha .01 masking takes under .1 % away from the rim.
    assert picture[12:24, 18:30].mean() == pytest.approx(1, abs=2e-3)
    assert picture[~ready.traced] == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize("height", [1, 2])
def test_an_environment_of_few_rows_is_linear_from_pole_to_pole(height, make_case, tmp_path):
    rows = np.array([0.5, 2.0][:height], np.float32)
    path = tmp_path / "few.exr"
    image = oiio.ImageOutput.create(str(path))
    image.open(str(path), oiio.ImageSpec(4, height, 3, oiio.FLOAT))
    image.write_image(np.ascontiguousarray(np.broadcast_to(rows[:, None, None], (height, 4, 3))))
    image.close()
    case = make_case().model_copy(update={"environment": Environment(name="few", path=path)})
    theta = np.linspace(0.01, np.pi - 0.01, 50)
    si = dr.zeros(mi.SurfaceInteraction3f, 50)
    si.wi = -mi.Vector3f(np.sin(theta), 0 * theta, np.cos(theta))
    seen = build_scene(case)[0].environment().eval(si).numpy()[0]
    assert seen == pytest.approx(
        np.interp(theta, np.linspace(0, np.pi, 2), rows[[0, -1]]), rel=1e-4
    )


@pytest.mark.parametrize("truth", ["unoccluded", "global"])
@pytest.mark.parametrize(
    "material",
    [metal(roughness=0.8, f0=(1, 0.6, 0.3), weight=0.3), plastic(weight=0.5, weight_g=1.0)],
    ids=["metal", "plastic"],
)
def test_a_sphere_in_uniform_light_has_its_directional_albedo(truth, material, make_case):
    # A long lens, so that the eye's direction is the same all over the sphere.
    far = Camera(origin=(0, -200, 0), target=(0, 0, 0), fov=0.7)
    case = make_case(material=material, camera=far, width=49, height=49)
    picture = stage(case, "model").trace(256, seed=2)[truth]
    radius = 49 / 2 / (200 * np.tan(np.radians(0.35)))
    y, x = np.mgrid[-24:25, -24:25] / radius
    for low, high in ((0, 0.2), (0.5, 0.6), (0.75, 0.8)):
        ring = (np.hypot(x, y) >= low) & (np.hypot(x, y) < high)
        expected = formula.directional_albedo(
            np.sqrt(1 - np.mean(x[ring] ** 2 + y[ring] ** 2)),
            material.diffuse_albedo,
            material.specular_f0,
            material.alpha,
            material.weight,
            material.masking_weight,
        )
        # 50 pixels of 256 samples, each some 60 % off: the mean is within .5 %, most of the time.
        assert picture[ring].mean(axis=0) == pytest.approx(expected, rel=0.01)


def test_unoccluded_ignores_a_neighbour_that_global_sees(make_case):
    floor = Object(name="floor", mesh="plane", material=plastic(albedo=(1, 1, 1)), scale=40)
    ball = Object(name="ball", mesh="sphere", material=BLACK, position=(0, 0, 1))
    camera = Camera(origin=(0, -8, 5), target=(0, 0, 0), fov=40)
    pictures = {}
    for truth in ("unoccluded", "global"):
        for objects in ((floor,), (floor, ball)):
            ready = stage(make_case(camera=camera, objects=objects), "model")
            pictures[truth, len(objects)] = ready.trace(256, seed=3)[truth]
    ids = ready.ids
    column, row = (int(v) for v in project(camera, 48, 36, (1.05, 0, 0)))
    assert ids[row, column] == 1  # floor, right beside where the ball stands
    spot = (slice(row, row + 1), slice(column, column + 1))
    change = {
        t: pictures[t, 2][spot].mean() / pictures[t, 1][spot].mean()
        for t in ("unoccluded", "global")
    }
    assert change["unoccluded"] == pytest.approx(1, abs=0.03)
    assert change["global"] < 0.8


@pytest.mark.parametrize(
    "camera", [SIDE, Camera(origin=(4, 3, 6), target=(0, 0, 0), up=(0, 1, 0.2), fov=50)]
)
def test_a_small_sphere_appears_where_a_pinhole_puts_it(camera, make_case):
    place = (1.1, 0.4, 1.3)
    objects = (
        Object(name="far", mesh="sphere", material=metal(), scale=1e-3, position=(0, 0, -0.5)),
        Object(name="ball", mesh="sphere", material=metal(), scale=0.25, position=place),
    )
    case = make_case(camera=camera, objects=objects, width=200, height=150)
    ids = stage(case, "model").ids
    rows, columns = np.nonzero(ids == case.index("ball"))
    x, y = project(camera, 200, 150, place)
    assert len(rows) > 20
    assert abs(columns.mean() + 0.5 - x) < 0.6
    assert abs(rows.mean() + 0.5 - y) < 0.6


@pytest.mark.parametrize("rotation", [0, 90, 215])
def test_one_bright_texel_is_seen_in_its_direction(rotation, make_case):
    sky = np.full((32, 64, 3), 0.1)
    row, column = 13, 37
    sky[row, column] = 50
    azimuth = 2 * np.pi * ((column + 0.5) / 64 - rotation / 360)
    theta = np.pi * row / 31  # rows are aligned to the poles
    to_sun = [np.sin(azimuth) * np.sin(theta), np.cos(azimuth) * np.sin(theta), np.cos(theta)]
    target = np.add(to_sun, [0.2, -0.1, 0.15])
    camera = Camera(origin=(0, 0, 0), target=tuple(target), fov=60)
    behind = Object(name="ball", mesh="sphere", material=metal(), position=tuple(-5 * target))
    case = make_case(
        sky, rotation=rotation, camera=camera, width=160, height=120, objects=(behind,)
    )
    grey = stage(case, "model").background.mean(axis=2)
    weight = grey - grey.min()
    x, y = project(camera, 160, 120, to_sun)
    # The texel's bilinear foot spans some 11 degrees, whose centroid a wide lens shifts a little.
    assert abs((weight * (np.arange(160) + 0.5)).sum() / weight.sum() - x) < 1.0
    assert abs((weight * (np.arange(120)[:, None] + 0.5)).sum() / weight.sum() - y) < 1.0


def test_a_sun_is_mirrored_where_the_law_of_reflection_says(make_case):
    sky = np.full((32, 64, 3), 1e-3)
    row, column = 9, 26
    sky[row, column] = 500
    azimuth, theta = 2 * np.pi * (column + 0.5) / 64, np.pi * row / 31
    to_sun = np.array(
        [np.sin(azimuth) * np.sin(theta), np.cos(azimuth) * np.sin(theta), np.cos(theta)]
    )
    eye = np.array([0.0, -40, 0])
    camera = Camera(origin=tuple(eye), target=(0, 0, 0), fov=3.5)
    case = make_case(sky, material=metal(roughness=0.1), camera=camera, width=96, height=96)
    ready = stage(case, "model")
    grey = np.where(ready.ids > 0, ready.trace(64, seed=5)["unoccluded"].mean(axis=2), 0)
    half = to_sun + eye / np.linalg.norm(eye)
    x, y = project(camera, 96, 96, half / np.linalg.norm(half))
    rows, columns = np.nonzero(grey > 0.5 * grey.max())
    assert abs(columns.mean() + 0.5 - x) < 1.0
    assert abs(rows.mean() + 0.5 - y) < 1.0


@pytest.mark.parametrize("truth", ["direct", "global", "physical"])
def test_pixels_are_those_that_mitsuba_itself_renders(truth, make_case):
    rng = np.random.default_rng(4)
    sky = rng.uniform(0.2, 2, (32, 64, 3))
    objects = (
        Object(name="a", mesh="sphere", material=metal(f0="Cu"), position=(0.7, 0, 0)),
        Object(name="b", mesh="sphere", material=plastic(), position=(-0.7, 0, 0.4), scale=0.6),
    )
    case = make_case(sky, objects=objects)
    samples = rounded_samples(256)
    ready = stage(case, kind_of(truth))
    found = ready.trace(samples, seed=6)[truth]
    scene, _ = build_scene(case, physical=truth == "physical")
    integrator = mi.load_dict({"type": "direct"} if truth == "direct" else PATH)
    runs = [mi.render(scene, integrator=integrator, seed=s, spp=samples).numpy() for s in range(4)]
    expected, spread = np.mean(runs, axis=0), float(np.std(runs, axis=0, ddof=1).mean())
    assert np.abs(found - expected).mean() < 1.5 * spread
    edges = expected[ready.traced & (ready.ids == 0)]
    assert found[ready.traced & (ready.ids == 0)] == pytest.approx(edges, abs=12 * spread)


def test_a_wavefront_in_pieces_gives_the_same_picture(make_case, monkeypatch):
    ready = stage(make_case(np.random.default_rng(5).uniform(0, 2, (32, 64, 3))), "model")
    whole = ready.trace(256, seed=2**32 - 1)["unoccluded"]
    monkeypatch.setattr(truths, "MAX_WAVEFRONT", 20_000)
    pieces = ready.trace(256, seed=2**32 - 1)["unoccluded"]
    assert not np.array_equal(whole, pieces)  # other seeds, so it was in pieces
    assert np.abs(whole - pieces).mean() < 0.02 * whole.mean()


def test_every_pixel_that_an_object_touches_is_traced(make_case):
    rng = np.random.default_rng(9)
    pixel = 2 * 5 * np.tan(np.radians(20)) / 36  # at the distance of the origin
    specks = tuple(
        Object(name=f"{i}", mesh="sphere", material=BLACK, scale=r * pixel, position=place)
        for i, (r, place) in enumerate(
            zip(rng.uniform(0.2, 0.6, 40), rng.uniform(-1.4, 1.4, (40, 3)), strict=True)
        )
    )
    case = make_case(objects=specks)
    ready = stage(case, "model")
    count = 400
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(9, 36 * 48 * count)
    index = dr.arange(mi.UInt32, 36 * 48 * count) // count
    position = mi.Point2f(index % 48, index // 48) + sampler.next_2d()
    hit = ready.scene.ray_test(camera_rays(ready.scene, case, position)).numpy()
    hit = hit.reshape(36, 48, count).any(axis=2)
    assert hit.sum() > 60
    assert ready.traced[hit].all()
    assert ready.traced.mean() < 0.4  # and not simply everything


def test_ids_traced_pixels_and_background_agree(make_case):
    ready = stage(make_case(), "model")
    assert set(np.unique(ready.ids)) == {0, 1}
    assert ready.traced[binary_dilation(ready.ids > 0, np.ones((3, 3)))].all()
    assert (ready.background[ready.traced] == 0).all()
    assert (ready.background[~ready.traced] > 0).all()


OCCLUDED = (
    Object(name="a", mesh="sphere", material=plastic(), position=(0.7, 0, 0)),
    Object(name="b", mesh="sphere", material=plastic(albedo=(1, 1, 1)), position=(-0.7, 0, 0)),
    Object(
        name="floor",
        mesh="plane",
        material=metal(roughness=0.6, f0="Cu"),
        scale=8,
        position=(0, 0, -1),
    ),
)


def test_the_control_variate_takes_noise_away_and_adds_no_bias(make_case, monkeypatch):
    sky = np.random.default_rng(7).uniform(0, 2, (32, 64, 3))
    ready = stage(make_case(sky, objects=OCCLUDED), "model")
    with_it = np.stack([ready.trace(16, seed)["global"] for seed in range(12)])
    monkeypatch.setitem(ready.__dict__, "control", np.zeros_like(ready.control))
    without = np.stack([ready.trace(16, seed)["global"] for seed in range(12)])
    light = without[:, ready.ids > 0].mean()
    spread = np.sqrt(without.var(axis=0)[ready.ids > 0].sum() / 12) / (ready.ids > 0).sum() / 3
    assert with_it[:, ready.ids > 0].mean() == pytest.approx(light, abs=5 * spread)
    lit = ready.ids == 1
    assert with_it.var(axis=0)[lit].mean() < 0.8 * without.var(axis=0)[lit].mean()


def test_open_directions_and_nothing_else_set_the_control(make_case):
    alone = stage(make_case(objects=OCCLUDED[:1]), "model")
    on = alone.ids[alone.traced] == 1
    assert alone.control[on].mean() == pytest.approx(0.75, abs=0.01)  # a sphere hides none of it
    assert stage(make_case(objects=OCCLUDED), "model").control.min() < 0.3


@pytest.mark.parametrize("truth", ["unoccluded", "direct", "global", "physical"])
def test_light_is_told_apart_by_the_lobe_that_reflects_it_first(truth, make_case):
    """The glossy lobe alone is what is left when the surface's albedo goes."""
    sky = np.random.default_rng(8).uniform(0, 2, (32, 64, 3))
    # With full transport a neighbour would send the white surface's own light back to it.
    objects = OCCLUDED if truth in ("unoccluded", "direct") else OCCLUDED[1:2]
    ready = stage(make_case(sky, objects=objects), kind_of(truth))
    pictures = ready.trace(256, seed=1)
    whole, diffuse = pictures[truth], pictures[f"{truth}.diffuse"]
    assert not diffuse[~ready.traced].any()
    white = binary_erosion(ready.ids == 1 + objects.index(OCCLUDED[1]))
    assert 0.5 * whole[white].mean() < diffuse[white].mean() < whole[white].mean()
    black = OCCLUDED[1].model_copy(update={"material": plastic(albedo=(0, 0, 0))})
    others = tuple(black if o is OCCLUDED[1] else o for o in objects)
    glossy = stage(make_case(sky, objects=others), kind_of(truth)).trace(256, seed=2)[truth]
    assert (whole - diffuse)[white].mean() == pytest.approx(glossy[white].mean(), rel=0.01)


def test_a_metal_has_no_diffuse_light(make_case):
    ready = stage(make_case(objects=OCCLUDED), "model")
    assert not ready.trace(16, seed=1)["global.diffuse"][binary_erosion(ready.ids == 3)].any()


def test_a_blend_of_stock_materials_agrees_with_samples_of_the_light_alone(make_case):
    """A density that were not the blend's own would be joined with the light's in the wrong way."""
    sky = np.full((32, 64, 3), 0.05)
    sky[6:9, 20:24] = 30.0
    half = {"roughness": 0.45, "metallic": 0.5, "metal": "Cu", "albedo": (0.6, 0.6, 0.6)}
    case = make_case(sky, material=Material(**half))
    ready = stage(case, "physical")
    found = np.mean([ready.trace(256, s)["physical"][ready.ids > 0].mean() for s in range(4)])
    scene, _ = build_scene(case, physical=True)
    light_only = mi.load_dict({"type": "direct", "emitter_samples": 1, "bsdf_samples": 0})
    picture = mi.render(scene, integrator=light_only, seed=3, spp=4096).numpy()
    assert found == pytest.approx(picture[ready.ids > 0].mean(), rel=0.004)
