"""Filtered samples of visible normals: their density, their noise, and what they come to."""

from dataclasses import replace

import numpy as np
import pytest

from renderer.draw import Renderer
from renderer.precompute import precomputed
from renderer.probe import probe
from renderer.techniques import technique
from reports.run.stability.sides import shader
from reports.stability import oracle
from scenes.schema import Camera, Environment, Material
from scenes.suite import HERE

SILVER = Material(roughness=0.1, metallic=1.0, metal="Ag")
PLASTIC = Material(albedo=(0.6, 0.3, 0.05), roughness=0.7, metallic=0.0, weight=0.5)


def drawn(case, name):
    return Renderer(technique(name), repeats=0).render(case)


def sphere_of_directions(polar: int, around: int):
    z, weights = np.polynomial.legendre.leggauss(polar)
    phi = (np.arange(around) + 0.5) * 2 * np.pi / around
    s = np.sqrt(1 - z**2)[:, None]
    w = np.stack([s * np.cos(phi), s * np.sin(phi), z[:, None] + 0 * phi], axis=2)
    return w.reshape(-1, 3).astype(np.float32), np.repeat(weights, around) * 2 * np.pi / around


@pytest.mark.parametrize("alpha", [0.1, 1.0])
@pytest.mark.parametrize("cosine", [0.2, 1.0])
def test_the_density_integrates_to_one_and_samples_follow_it(alpha, cosine):
    wo = np.float32([[np.sqrt(1 - cosine**2), 0, cosine]])
    wi, omega = sphere_of_directions(300, 600)
    density = shader("pdf_visible_ggx", {"wi": wi, "wo": wo, "alpha": np.float32(alpha)})[:, 0]
    assert density @ omega == pytest.approx(1, abs=3e-3)
    u = oracle.hammersley(np.arange(65536), np.full(65536, 65536)).astype(np.float32)
    h = shader("sample_visible_ggx", {"u": u, "wo": wo, "alpha": np.float32(alpha)}).astype(float)
    sent = 2 * (h @ wo[0])[:, None] * h - wo
    for axis in ([0, 0, 1], [-0.6, 0, 0.8], [0, 1, 0]):
        for least in (-0.5, 0.3, 0.9):
            share = (sent @ axis > least).mean()
            assert share == pytest.approx(density @ (omega * (wi @ axis > least)), abs=6e-3)


def test_a_blurred_map_of_even_light_is_even(light):
    made = precomputed(light((0.7, 0.2, 3.0), size=(32, 64)))
    made.need(["blurred_map"])
    for level in range(6):
        texels = np.frombuffer(made.maps["blurred_map"].read(level=level), np.float32)
        assert texels.reshape(-1, 4)[:, :3] == pytest.approx(
            np.broadcast_to([0.7, 0.2, 3.0], (len(texels) // 4, 3)), rel=1e-5
        )


@pytest.mark.parametrize("material", [SILVER, PLASTIC])
def test_neighbouring_pixels_err_alike(make_case, material):
    """On a plane the picture turns slowly: what changes from pixel to pixel is noise."""
    camera = Camera(origin=(0, -4, 2), target=(0, 0, 0), fov=4)
    plane = ("plane", material, {"scale": 5.0})
    case = make_case(HERE / "environments" / "studio.exr", plane, size=(48, 48), camera=camera)

    def noise(name):
        rgb = Renderer(replace(technique(name), msaa=0), repeats=0).render(case).rgb[..., 0]
        return np.abs(np.diff(rgb, 2, axis=1)).mean() / rgb.mean()

    assert noise("filtered") < 0.1 * noise("sampled@64") or noise("filtered") < 1e-3


@pytest.mark.parametrize("weight", [1.0, 0.5, 0.0])
@pytest.mark.parametrize("roughness", [0.1, 0.4, 0.7, 1.0])
def test_even_light_is_reflected_as_much_as_by_many_directions(light, make_case, weight, roughness):
    metal = Material(roughness=roughness, metallic=1.0, metal="Cu", weight=weight)
    case = make_case(light(1.0), ("sphere", metal, {}), size=(40, 40))
    few, many = (
        Renderer(technique(n), repeats=0).render(case) for n in ("filtered", "sampled@4096")
    )
    on = few.ids > 0
    assert few.rgb[on].mean() == pytest.approx(many.rgb[on].mean(), rel=5e-3)


@pytest.mark.parametrize("name", ["sunset", "interior"])
def test_a_small_light_leaves_no_fireflies_on_rough_metal(make_case, copper, name):
    case = make_case(
        HERE / "environments" / f"{name}.exr", ("sphere", copper(0.16), {}), size=(48, 48)
    )
    few, many = (
        Renderer(replace(technique(n), grid=1), repeats=0).render(case)
        for n in ("filtered", "filtered@4096")
    )
    on = few.ids > 0
    assert few.rgb[on].max() < 1.1 * many.rgb[on].max()
    assert few.rgb[on].mean() == pytest.approx(many.rgb[on].mean(), rel=0.02)


def test_lights_are_compiled_in_only_where_there_are_any(light, make_case, copper):
    sun = np.full((32, 64, 3), 0.1)
    sun[8, 20] = 1e4

    def uniforms(radiance):
        case = make_case(light(radiance), ("sphere", copper(0.2), {}), size=(16, 16))
        how = Renderer(technique("filtered"), repeats=0)
        maps = precomputed(case.environment.path)
        maps.need(how.technique.maps(copper(0.2)))
        (draw,) = how.prepare(case, maps.maps).draws
        return set(draw.shading)

    assert "light_count" in uniforms(sun)
    assert "light_count" not in uniforms(0.1)


def test_sets_of_a_pixel_fill_one_anothers_gaps():
    index = np.tile(np.arange(16), 4)
    given = {"i": index, "set": np.repeat(np.arange(4), 16)}
    call = "vec4(spiral(int(i.x), 16, int(set.x), 4), 0.0, 0.0)"
    points = probe(call, given, ("spiral.glsl",))[:, :2]
    assert len(np.unique(np.round(points[:, 0] * 64 - 0.5))) == 64  # rings
    apart = np.abs(points[:, None] - points[None])
    apart = np.hypot(apart[..., 0], np.minimum(apart[..., 1], 1 - apart[..., 1]))
    assert (apart + np.eye(64)).min() > 0.25 / 8  # a quarter of an even spacing


def test_environments_may_be_turned(make_case, copper):
    """A light is where the environment shows it, whatever the turn."""
    camera = Camera(origin=(0, 0, 8), target=(0, 0, 0), fov=18, up=(0, 1, 0))

    def picture(rotation, turned):
        case = make_case(
            HERE / "environments" / "studio.exr",
            ("sphere", copper(0.16), {}),
            size=(40, 40),
            camera=turned,
            rotation=rotation,
        )
        assert isinstance(case.environment, Environment)
        return Renderer(replace(technique("filtered"), msaa=0), repeats=0).render(case).rgb

    upright = picture(0.0, camera)
    turned = picture(90.0, camera.model_copy(update={"up": (1.0, 0.0, 0.0)}))
    off = min(np.abs(upright - turned).max(), np.abs(upright - turned[::-1, ::-1]).max())
    assert off < 0.02 * upright.max()


def test_nothing_is_darker_than_black(make_case):
    """Kernels of fourth order have negative rims, and a narrow lobe may stand in one."""
    silver = Material(roughness=0.1, metallic=1.0, metal="Ag", weight=0.0)
    case = make_case(HERE / "environments" / "studio.exr", ("sphere", silver, {}), size=(96, 96))
    assert drawn(case, "filtered@16").rgb.min() >= 0


@pytest.mark.parametrize("tilt", [0.0, 30.0])
def test_a_floor_under_a_low_sun_gets_its_light(make_case, tilt):
    """Few directions see a bright horizon too much or too little; what is missing is known."""
    matte = Material(albedo=(0.8,) * 3, f0=0.05, roughness=0.8, metallic=0.0)
    floor = ("plane", matte, {"scale": 9.0, "rotate": (tilt, 0.0, 0.0)})
    camera = Camera(origin=(0, -3, 6), target=(0, 0, 0), fov=20)
    case = make_case(HERE / "environments" / "sunset.exr", floor, camera=camera)
    few, many = (drawn(case, name) for name in ("filtered", "sampled@32768"))
    inside = few.ids > 0
    assert few.rgb[inside].mean() == pytest.approx(many.rgb[inside].mean(), rel=0.01)
