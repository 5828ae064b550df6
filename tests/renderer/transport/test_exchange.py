"""What vertices receive of an environment, and of one another."""

import numpy as np
import pytest

from renderer.draw import Renderer
from renderer.precompute import precomputed
from renderer.probe import brdf_values, probe
from renderer.shading import Shading
from renderer.techniques import technique
from renderer.transport.exchange import MOST_KEPT, _ahead
from renderer.transport.scene import scene_geometry
from renderer.transport.tessellation import tessellate
from scenes.schema import Camera, Material, Model

GREY = Material(albedo=(0.5, 0.5, 0.5), f0=0.0, roughness=0.5, metallic=0.0)
ABOVE = Camera(origin=(0, -4, 4), target=(0, 0, 0), fov=40)


def precomputed_maps(case):
    """All maps that `best` reads of a case's environment."""
    made = precomputed(case.environment.path)
    made.need(sorted({m for o in case.objects for m in technique("best").maps(o.material)}))
    return made.maps


def integrated_diffuse(material, model, cosines):
    """The diffuse lobe's albedo towards each cosine, over its own albedo of 1."""
    u, v = (np.mgrid[:96, :192].reshape(2, -1) + 0.5) / [[96], [192]]
    z, phi = np.sqrt(u), 2 * np.pi * v
    wi = np.stack([np.sqrt(1 - u) * np.cos(phi), np.sqrt(1 - u) * np.sin(phi), z], axis=1)
    black = material.model_copy(update={"albedo": (1e-6,) * 3})
    found = []
    for c in cosines:
        wo = np.tile([np.sqrt(1 - c * c), 0, c], (len(wi), 1))
        # Under every kd but `conserving` the rest of the BRDF does not know of the albedo.
        f = brdf_values(material, wi, wo, model) - brdf_values(black, wi, wo, model)
        found.append(np.pi * f.mean(axis=0))
    return np.array(found)


@pytest.mark.parametrize(
    "model",
    [
        Model(),
        Model(fresnel="f82"),
        Model(fresnel="exact", kd="interface", masking="smith"),
        Model(kd="conserving", masking="smith"),
    ],
    ids=lambda m: f"{m.fresnel} {m.kd}",
)
def test_what_a_surface_sends_another_is_what_its_diffuse_lobe_does(light, make_case, model):
    material = Material(albedo=(1.0, 1.0, 1.0), f0=0.1, roughness=0.6, metallic=0.0)
    case = make_case(light(1.0), ("sphere", material, {})).model_copy(update={"model": model})
    shading = Shading(technique("best"), case)
    cosines = np.array([0.15, 0.4, 0.7, 0.99])
    found = probe(
        "vec4(diffuse_share(material_of(0), c.x), 0.0)",
        {"c": cosines},
        ("surface_light.glsl",),
        shading.any_material,
        maps=shading.material_maps,
    )[:, :3]
    np.testing.assert_allclose(found, integrated_diffuse(material, model, cosines), rtol=6e-3)


def test_a_vertex_gets_what_shines_on_it(light, make_case):
    """A floor under a sky with one bright patch, which lies between the directions looked at."""
    v, u = np.mgrid[:64, :128] + 0.5
    sky = (1.5 - v / 64) + 20 * np.exp(-((v - 18) ** 2 + (u - 80) ** 2) / 16)
    case = make_case(light(sky[..., None] * np.ones(3)), ("plane", GREY, {}), camera=ABOVE)
    prepared = Renderer(technique("best")).prepare(case, precomputed_maps(case))
    texels = np.frombuffer(prepared.draws[0].maps["irradiance"].read(), np.float32)
    floor = texels.reshape(-1, 4)[: len(tessellate(case)[0].vertices), :3]
    polar = np.linspace(0, np.pi / 2, 20_001)
    middle = (polar[1:] + polar[:-1]) / 2
    rows = np.interp(middle / np.pi * 63, np.arange(64), sky.mean(axis=1))
    truth = 2 * np.pi * (rows * np.cos(middle) * np.sin(middle)).sum() * (polar[1] - polar[0])
    np.testing.assert_allclose(floor, truth, rtol=0.002)


def test_colours_in_32_bits_are_within_a_255th_of_their_largest_channel():
    rng = np.random.default_rng(4)
    colours = np.float32(10 ** rng.uniform(-20, 20, (4000, 1)) * rng.random((4000, 4)))
    colours[0], colours[1], colours[2, :2] = 0, np.nextafter(np.float32(2), 0), 0
    found = probe("vec4(from_rgbe(to_rgbe(c.rgb)), 0.0)", {"c": colours}, ("rgbe.glsl",))[:, :3]
    colours = colours[:, :3]
    off = np.abs(found - colours) / np.maximum(colours.max(axis=1, keepdims=True), 1e-30)
    assert off.max() < 1 / 255 and not found[0].any()
    assert abs(((found - colours) / colours.max(axis=1, keepdims=True).clip(1e-30)).mean()) < 1e-4


def test_later_bounces_are_told_from_the_first_ones():
    """Light that keeps a third from bounce to bounce adds half of a bounce after it."""
    sums = [np.full(3, x) for x in (9.0, 12.0, 13.0)]
    np.testing.assert_allclose(_ahead(sums), 0.5)
    nothing, growing = np.zeros(3), [np.full(3, x) for x in (1.0, 2.0, 4.0)]
    assert _ahead([nothing] * 3) == (0.0, 0.0, 0.0)
    np.testing.assert_allclose(_ahead(growing), MOST_KEPT / (1 - MOST_KEPT))
    assert np.isfinite(_ahead([nothing, nothing, np.array([np.nan, np.inf, 1.0])])).all()


def test_each_object_may_look_finely(ball_and_plate):
    """The sights of one object may be made in another way than those of the next."""
    geometry = scene_geometry(ball_and_plate)
    first = geometry.first_sight
    owners = np.frombuffer(geometry.maps["sight_owner"].read(), np.uint32)[: first[-1]]
    numbers = np.frombuffer(geometry.maps["normals"].read(), np.float32)[3::4]
    for k in range(2):
        assert (numbers[owners[first[k] : first[k + 1]]] == k).all()
    assert first[0] == 0 < first[1] < first[2]
