"""Materials with a direction and maps, as the shaders draw them."""

from dataclasses import replace

import numpy as np
import OpenImageIO as oiio
import pytest

from renderer.draw import Renderer
from renderer.features import LOBES, VARYING, features
from renderer.precompute import texture
from renderer.precompute.texture import _cell_means, _pyramid
from renderer.techniques import technique
from renderer.transport.placed import placed_meshes
from renderer.transport.tessellation import tessellate, untouched
from scenes.schema import Camera, Maps, Material, Model, Object
from scenes.suite import HERE

IRON = {"metallic": 1.0, "metal": "Fe"}
WORN = {n: str(HERE / "textures" / f"worn_{n}.png") for n in ("albedo", "roughness", "metallic")}
HAMMERED = str(HERE / "textures" / "hammered_normal.png")
NEAR = Camera(origin=(0, -6, 2), target=(0, 0, 0), fov=24)


@pytest.fixture
def picture(tmp_path):
    def write(name, pixels):
        pixels = np.ascontiguousarray(np.float32(pixels))
        path = str(tmp_path / f"{name}.exr")
        image = oiio.ImageOutput.create(path)
        image.open(path, oiio.ImageSpec(*pixels.shape[1::-1], pixels.shape[2], oiio.FLOAT))
        image.write_image(pixels)
        image.close()
        return path

    return write


def drawn(case, name="sampled@64", **changes):
    return Renderer(replace(technique(name), **changes), repeats=0).render(case).rgb


def whole(material, **maps):
    return material.model_copy(update={"maps": Maps(**maps)})


def test_nothing_of_it_is_compiled_in_for_a_plain_material():
    plain = Material(roughness=0.5, albedo=(0.5, 0.5, 0.5), metallic=0.5, metal="Cu", weight=0.5)
    assert features(plain) == {f.name for f in LOBES}
    assert technique("sampled").features(plain) == features(plain)


def test_each_map_brings_what_it_needs():
    added = {f.name for f in VARYING}
    iron = Material(roughness=1.0, albedo=(1, 1, 1), **IRON)
    found = features(whole(iron, metallic=WORN["metallic"], weight="vertex"))
    expected = {"VARIES", "TEXTURED", "MAP_METALLIC", "VERTEX_NUMBERS", "VARIES_WEIGHT"}
    assert found & added == expected | {"MASKING_FOLLOWS"}
    assert {"D_BECKMANN", "G_BECKMANN", "DIFFUSE"} <= found  # somewhere on the mesh
    sampled, paper = technique("sampled"), technique("paper")
    directed = iron.model_copy(update={"anisotropy": 0.5})
    assert "ANISOTROPIC" in sampled.features(directed)
    assert "ANISOTROPIC" in sampled.features(whole(iron, normal=HAMMERED))
    assert "ANISOTROPIC" not in paper.features(whole(iron, normal=HAMMERED))


def test_the_split_sum_says_what_it_cannot_draw():
    paper, iron = technique("paper"), Material(roughness=1.0, **IRON)
    mapped, directed = whole(iron, normal=HAMMERED), iron.model_copy(update={"anisotropy": 0.5})
    smith = Model(masking="smith")
    assert paper.cannot_draw(Model(), [mapped]) == "" == paper.cannot_draw(smith, [iron])
    assert paper.cannot_draw(Model(), [mapped, directed]) == "anisotropy"
    assert "maps with this masking" in paper.cannot_draw(smith, [mapped])
    assert technique("sampled").cannot_draw(smith, [mapped, directed]) == ""


@pytest.mark.parametrize("name", ["sampled@64", "paper", "filtered"])
def test_maps_of_one_value_draw_what_the_number_draws(name, light, make_case, picture):
    rng = np.random.default_rng(2)
    sky = light(rng.random((16, 32, 3)) * [[[1.0, 2.0, 0.5]]])
    number = Material(
        roughness=0.4, albedo=(0.2, 0.4, 0.1), metallic=0.25, metal="Cu", weight=0.5, f0=0.04
    )
    flat = picture("flat", np.full((4, 4, 3), 0.5))
    tint = picture("tint", np.full((2, 2, 3), [0.2, 0.4, 0.1]))
    maps = {"albedo": tint, "roughness": flat, "metallic": flat, "weight": flat}
    mapped = number.model_copy(
        update={
            "roughness": 0.8,
            "albedo": (1.0, 1.0, 1.0),
            "metallic": 0.5,
            "weight": 1.0,
            "maps": Maps(**maps, repeat=3.0),
        }
    )
    # Without coverage samples, whose directions differ once a picture is finer than a pixel.
    pictures = [drawn(make_case(sky, ("globe", m, {})), name, msaa=0) for m in (number, mapped)]
    assert np.abs(pictures[0] - pictures[1]).max() < 2e-3 * pictures[0].max()


def test_a_flat_normal_map_draws_what_none_draws(light, make_case, picture):
    sky = light(np.random.default_rng(2).random((16, 32, 3)))
    flat = picture("flat", np.full((4, 4, 3), [0.5, 0.5, 1.0]))
    iron = Material(roughness=0.5, **IRON)
    # A direction turns the samples: with an anisotropy that is next to none both have one.
    directed = iron.model_copy(update={"anisotropy": 1e-6})
    cases = [make_case(sky, ("globe", m, {})) for m in (directed, whole(iron, normal=flat))]
    pictures = [drawn(case, msaa=0) for case in cases]
    assert np.abs(pictures[0] - pictures[1]).max() < 2e-3 * pictures[0].max()


def test_a_lobe_turned_by_a_quarter_is_that_with_its_widths_swapped(light, make_case):
    sky = light(np.random.default_rng(2).random((16, 32, 3)))
    iron = Material(roughness=0.5, anisotropy=0.8, **IRON)
    turned = iron.model_copy(update={"anisotropy": -0.8, "rotation": 90.0})
    other = iron.model_copy(update={"anisotropy": -0.8})
    a, b, c = (
        drawn(make_case(sky, ("cylinder", m, {})), "sampled@1024") for m in (iron, turned, other)
    )
    assert np.abs(a - b).mean() < 0.02 * a.mean() < np.abs(a - c).mean()


@pytest.mark.parametrize("anisotropy", [-1.0, 0.5, 1.0])
@pytest.mark.parametrize("mesh", ["cylinder", "sphere"])
def test_in_white_light_facets_with_a_direction_send_back_no_more_than_comes(
    mesh, anisotropy, light, make_case
):
    white = Material(roughness=0.5, anisotropy=anisotropy, metallic=1.0, metal=1.0, weight=0.5)
    case = make_case(light(1.0), (mesh, white, {}))
    case = case.model_copy(update={"model": Model(masking="smith")})
    rgb = drawn(case, "sampled@4096")
    assert np.isfinite(rgb).all() and rgb.max() < 1.01
    assert np.median(rgb[20:28, 28:36]) > 0.9  # alpha is .25: a tenth is lost at most


@pytest.mark.parametrize(
    ("mesh", "changes", "maps"),
    [
        ("globe", {"roughness": 0.0, "anisotropy": 1.0}, {"normal": HAMMERED}),
        (
            "cylinder",
            {"roughness": 1.0, "anisotropy": -1.0},
            {"normal": HAMMERED, "repeat": 1000.0},
        ),
        ("plane", {"roughness": 1.0}, {**WORN, "normal": HAMMERED, "repeat": 0.001}),
        ("sphere", {"roughness": 1e-3, "anisotropy": 1.0, "rotation": 45.0}, {}),
    ],
)
@pytest.mark.parametrize("name", ["sampled@64", "filtered"])
def test_hard_inputs_give_finite_light(name, mesh, changes, maps, light, make_case):
    sky = light(np.random.default_rng(2).random((16, 32, 3)))
    material = Material(**{"albedo": (1, 1, 1), **IRON, **changes}, maps=Maps(**maps))
    for camera in (NEAR, Camera(origin=(0, -60, 0.5), target=(0, 0, 0), fov=2)):
        rgb = drawn(make_case(sky, (mesh, material, {}), camera=camera), name)
        assert np.isfinite(rgb).all() and (rgb >= 0).all() and rgb.max() < 1e3


def test_a_picture_of_one_texel_and_triangles_without_texture_area_are_drawn(
    light, make_case, picture, tmp_path
):
    import trimesh

    corners = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], float)
    mesh = trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], process=False)
    mesh.visual = trimesh.visual.TextureVisuals(uv=np.full((4, 2), 0.3))
    mesh.export(tmp_path / "flat.ply")
    maps = {
        "albedo": picture("one", [[[0.5, 0.25, 0.125]]]),
        "normal": picture("n", [[[0.6, 0.5, 0.9]]]),
    }
    matte = Material(roughness=1.0, albedo=(1, 1, 1), metallic=0.0, f0=0.0, maps=Maps(**maps))
    rgb = drawn(make_case(light(1.0), (str(tmp_path / "flat.ply"), matte, {})), "sampled@256")
    middle = rgb[20:28, 28:36].mean(axis=(0, 1))
    assert np.allclose(middle / middle[0], [1, 0.5, 0.25], atol=0.02)


def test_means_of_a_picture_are_those_of_the_bilinear_one():
    texels = np.random.default_rng(4).random((5, 6, 1))
    n = 64
    place = (np.arange(6 * n) + 0.5) / n - 0.5, (np.arange(5 * n) + 0.5) / n - 0.5
    x, y = (np.floor(p).astype(int) for p in place)
    fx, fy = (place[0] - x)[None, :], (place[1] - y)[:, None]

    def at(j, i):
        return texels[(y + j)[:, None] % 5, (x + i)[None, :] % 6, 0]

    fine = (1 - fy) * ((1 - fx) * at(0, 0) + fx * at(0, 1)) + fy * (
        (1 - fx) * at(1, 0) + fx * at(1, 1)
    )
    expected = (fine**4).reshape(5, n, 6, n).mean(axis=(1, 3))
    assert np.abs(_cell_means(texels, lambda r: r**4)[..., 0] - expected).max() < 1e-4
    levels = _pyramid(texels, texels, lambda r: r**4)
    assert levels[0] is not None and (levels[0] == np.float32(texels)).all()
    assert [level.shape[:2] for level in levels] == [(5, 6), (2, 3), (1, 1)]
    assert levels[-1].item() == pytest.approx(expected.mean(), rel=1e-4)


def test_what_vertices_carry_is_halved_with_the_triangles(light, make_case):
    maps = {"roughness": WORN["roughness"]}
    plain, mapped = (Material(roughness=1.0, maps=m, **IRON) for m in (Maps(), Maps(**maps)))
    case = make_case(
        light(1.0), ("plane", mapped, {}), ("sphere", plain, {"position": (0, 0, 1.2)})
    )
    floor, ball = tessellate(case)
    assert len(floor.carried) == len(floor.vertices) > 4 and ball.carried.shape[1] == 0
    assert np.abs(floor.carried[:, :2] - (floor.vertices[:, :2] + 0.5)).max() < 1e-6
    assert len(untouched(case)[0].vertices) == 4
    assert set(placed_meshes(case).maps) >= {"vertex_uv", "corners"}
    bare = case.model_copy(update={"objects": case.objects[1:]})
    assert "vertex_uv" not in placed_meshes(bare).maps


def test_one_picture_lies_on_the_gpu_once():
    both = [
        Object(
            name=n,
            mesh="globe",
            material=Material(roughness=1.0, maps=Maps(roughness=WORN["roughness"]), **IRON),
        )
        for n in "ab"
    ]
    assert texture.make(both[0])["roughness_map"] is texture.make(both[1])["roughness_map"]
