"""The plugin `varying`: directions, maps, and stock plugins beside it."""

import drjit as dr
import numpy as np
import OpenImageIO as oiio
import pytest

from reference.physical import physical_bsdf
from reference.scene_dict import mesh, model_bsdf
from reference.store import contents
from reference.variant import mitsuba
from scenes.errors import InputError
from scenes.mesh import world_mesh
from scenes.schema import PHYSICAL, Maps, Material, Model, Object
from scenes.suite import Sampling
from scenes.surface import surface
from tests.reference.evaluating import chi2, directions, evaluate

mi = mitsuba()
IRON = {"metallic": 1.0, "metal": "Fe"}


def bsdf(material, mesh="plane", model=None):
    found, _ = model_bsdf(Object(name="o", mesh=mesh, material=material), model or Model())
    return mi.load_dict(found)


def seen(obj, points, model=None):
    """Interactions of rays straight down on an object in z = 0."""
    found, _ = model_bsdf(obj, model or Model())
    shape = mesh(world_mesh(obj), found, "o", surface(obj).carried)
    scene = mi.load_dict({"type": "scene", "o": shape})
    x, y = np.float32(points).T
    ray = mi.Ray3f(mi.Point3f(x, y, 1), mi.Vector3f(0, 0, -1))
    si = scene.ray_intersect(ray)
    dr.eval(si)
    return scene, si  # the scene must live as long as its shape


def mirrored_up(obj, points):
    """f cos for light and eye straight above."""
    scene, si = seen(obj, points)
    up = si.to_local(mi.Vector3f(0, 0, 1))
    return np.array(si.bsdf().eval(mi.BSDFContext(), si, up)).T[:, 0], scene


@pytest.fixture
def picture(tmp_path):
    def write(pixels):
        pixels = np.ascontiguousarray(np.float32(pixels)[..., None].repeat(3, axis=2))
        path = tmp_path / f"{len(list(tmp_path.iterdir()))}.exr"
        image = oiio.ImageOutput.create(str(path))
        image.open(str(path), oiio.ImageSpec(*pixels.shape[1::-1], 3, oiio.FLOAT))
        image.write_image(pixels)
        image.close()
        return str(path)

    return write


CHI2 = [(a, w, angle) for a in (0.9, -0.6) for w in (0.0, 0.5, 1.0) for angle in (15, 60, 80)]


@pytest.mark.parametrize(("anisotropy", "weight", "angle"), CHI2)
def test_samples_have_the_density_that_pdf_says(anisotropy, weight, angle, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    material = Material(roughness=0.6, anisotropy=anisotropy, weight=weight, **IRON)
    turned = material.model_copy(update={"rotation": 30.0})
    test = chi2(bsdf(turned), angle)
    assert test.run(significance_level=0.01, test_count=len(CHI2), quiet=True), test.messages


def test_ggx_of_bare_metal_is_mitsubas_own_along_u():
    material = Material(roughness=0.6, anisotropy=0.8, **IRON)
    obj = Object(name="o", mesh="plane", material=material)
    stock = mi.load_dict(physical_bsdf(obj)[0])
    wi, wo = directions(0.3)
    expected = evaluate(stock, wi, wo)
    ours = bsdf(material, model=Model(fresnel="exact", masking="smith"))
    found = evaluate(ours, wi, wo)
    assert np.max(np.abs(found - expected) / np.maximum(expected, 1e-4 * expected.max())) < 1e-4


@pytest.mark.parametrize(
    "changes",
    [
        {"rotation": 10.0},
        {"maps": Maps(roughness="vertex")},
        {"metallic": 0.5, "albedo": (1, 1, 1)},
    ],
)
def test_what_no_stock_plugin_has_is_refused(changes):
    material = Material(**{"roughness": 0.6, "anisotropy": 0.8, **IRON, **changes})
    with pytest.raises(InputError, match="leave the truth `physical` out"):
        physical_bsdf(Object(name="o", mesh="plane", material=material))
    with pytest.raises(InputError, match="no maps"):
        physical_bsdf(Object(name="o", mesh="sphere", material=material))


def test_models_of_one_width_are_refused():
    material = Material(roughness=0.6, anisotropy=0.8, metallic=0.0, albedo=(0.5, 0.5, 0.5))
    with pytest.raises(InputError, match="change the model"):
        bsdf(material, model=PHYSICAL)


def test_a_picture_lies_with_its_lower_left_corner_at_the_origin_of_uv(picture):
    # Roughness .2 in the lower left quarter alone, upper rows first.
    path = picture([[1.0, 1.0], [0.2, 1.0]])
    material = Material(roughness=1.0, maps=Maps(roughness=path), **IRON)
    obj = Object(name="o", mesh="plane", material=material)
    places = np.array([[-1, -1], [1, -1], [-1, 1], [1, 1]]) / 4
    found, _scene = mirrored_up(obj, places)
    smooth = found[0] / found[1:]
    assert np.allclose(smooth, (1 / 0.2) ** 4, rtol=1e-3)  # 1 / alpha²


def test_between_texels_a_picture_is_bilinear_and_it_repeats(picture):
    path = picture([[0.4, 0.8]])
    material = Material(roughness=1.0, maps=Maps(roughness=path, repeat=2.0), **IRON)
    obj = Object(name="o", mesh="plane", material=material)
    u = np.array([0.125, 0.25, 0.375, 0.5, 0.625])  # .25, .5, .75, 1 and 1.25 of the picture
    found, _scene = mirrored_up(obj, np.stack([u - 0.5, 0 * u + 0.1], axis=1))
    roughness = (found[0] / found) ** 0.25 * 0.4
    assert np.allclose(roughness, [0.4, 0.6, 0.8, 0.6, 0.4], rtol=1e-3)


def test_a_normal_map_turns_the_lobe_towards_its_slope(tmp_path):
    slope = np.array([0.3, 0.0, 1.0])
    encoded = (slope / np.linalg.norm(slope) + 1) / 2
    path = str(tmp_path / "n.exr")
    image = oiio.ImageOutput.create(path)
    image.open(path, oiio.ImageSpec(1, 1, 3, oiio.FLOAT))
    image.write_image(np.float32(encoded).reshape(1, 1, 3))
    image.close()
    material = Material(roughness=0.3, maps=Maps(normal=path), **IRON)
    obj = Object(name="o", mesh="plane", material=material)
    _scene, si = seen(obj, [[0.1, 0.2]] * 9)
    angle = np.linspace(0.0, 1.2, 9)
    light = mi.Vector3f(np.float32(np.sin(angle)), 0, np.float32(np.cos(angle)))
    f = np.array(si.bsdf().eval(mi.BSDFContext(), si, si.to_local(light)))[0]
    assert abs(angle[f.argmax()] - 2 * np.arctan(0.3)) < 0.1


def test_keys_hold_what_varies_and_nothing_for_what_does_not(picture, make_case):
    def key(material):
        ball = Object(name="ball", mesh="globe", material=material)
        return contents(make_case(objects=(ball,)), "model", Sampling())["objects"][0]

    plain = Material(roughness=1.0, **IRON)
    maps = [Maps(roughness=picture([[v]])) for v in (0.5, 0.6)]
    keys = [key(plain.model_copy(update={"maps": m})) for m in maps]
    assert "varies" not in key(plain) and keys[0] != keys[1]
    turned = [key(plain.model_copy(update={"anisotropy": 0.5, "rotation": r})) for r in (0.0, 9.0)]
    assert turned[0] != turned[1] and "varies" in turned[0]
