"""Materials with a direction and maps: what is read, and what is refused."""

import numpy as np
import OpenImageIO as oiio
import pytest
import trimesh

from scenes.mesh import load_mesh
from scenes.schema import ALPHA_MIN, Maps, Material, Object
from scenes.suite import expand, load_suite
from scenes.surface import finest_alpha, plain, surface
from scenes.tangents import world_tangents
from scenes.texture import load_texture

IRON = {"metallic": 1.0, "metal": "Fe"}


@pytest.fixture
def picture(tmp_path):
    """Write a picture (H, W, C) of a depth, and return its path."""

    def write(name, pixels, depth="uint8"):
        pixels = np.ascontiguousarray(np.atleast_3d(pixels), np.float32)
        path = tmp_path / name
        image = oiio.ImageOutput.create(str(path))
        image.open(str(path), oiio.ImageSpec(*pixels.shape[1::-1], pixels.shape[2], depth))
        image.write_image(pixels)
        image.close()
        return path

    return write


@pytest.fixture
def quad(tmp_path):
    """Write a unit square that carries what is asked, and return its path."""

    def write(kind="ply", **carried):
        corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
        mesh = trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], process=False)
        if "uv" in carried:
            mesh.visual = trimesh.visual.TextureVisuals(uv=np.array(carried.pop("uv"), float))
        mesh.vertex_attributes.update({k: np.asarray(v) for k, v in carried.items()})
        path = tmp_path / f"quad{len(list(tmp_path.iterdir()))}.{kind}"
        mesh.export(path)
        return str(path)

    return write


def thing(mesh, maps=None, **fields):
    rest = {"roughness": 1.0, "albedo": (1.0, 1.0, 1.0)} | IRON | fields
    return Object(name="thing", mesh=mesh, material=Material(maps=Maps(**(maps or {})), **rest))


@pytest.mark.parametrize("anisotropy", [-1.0, -0.5, 0.0, 0.3, 1.0])
def test_anisotropy_keeps_the_mean_of_the_squares(anisotropy):
    material = Material(roughness=0.5, anisotropy=anisotropy, **IRON)
    along, across = material.alphas
    assert np.mean([along**2, across**2]) == pytest.approx(material.alpha**2, rel=1e-6)
    assert (along > across) == (anisotropy > 0) and min(along, across) >= ALPHA_MIN
    if abs(anisotropy) == 1:
        assert min(along, across) == ALPHA_MIN


def test_a_plain_material_has_one_width_to_the_last_bit():
    material = Material(roughness=0.37, **IRON)
    assert material.alphas == (material.alpha,) * 2 and not material.varies
    assert finest_alpha(Object(name="o", mesh="sphere", material=material)) == material.alpha


def test_tangents_run_along_u():
    found = world_tangents(thing("cylinder").model_copy(update={"rotate": (0.0, 90.0, 0.0)}))
    mesh = load_mesh("cylinder")
    side = np.abs(mesh.normals[:, 2]) < 0.5
    around = np.cross([0, 0, 1], mesh.normals[side])
    turned = np.stack([around[:, 2], around[:, 1], -around[:, 0]], axis=1)
    assert np.abs(found[side, :3] - turned).max() < 1e-5
    assert (found[side, 3] == 1).all()


def test_without_texture_coordinates_tangents_run_around_z_and_exist_on_the_axis():
    found, n = world_tangents(thing("sphere")), load_mesh("sphere").normals
    around = np.cross([0.0, 0, 1], n)
    off_axis = np.linalg.norm(around, axis=1) > 1e-3
    around = around[off_axis] / np.linalg.norm(around[off_axis], axis=1)[:, None]
    assert np.abs(found[off_axis, :3] - around).max() < 1e-5
    assert np.allclose(np.linalg.norm(found[:, :3], axis=1), 1, atol=1e-6)
    assert np.abs((found[:, :3] * n).sum(axis=1)).max() < 1e-6


@pytest.mark.parametrize(
    "uv",
    [
        [[0, 0]] * 4,  # all at one point
        [[0, 0], [1, 0], [2, 0], [3, 0]],  # on a line
        [[0, 0], [0, 1], [-1, 1], [-1, 0]],  # turned
        [[1, 0], [0, 0], [0, 1], [1, 1]],  # mirrored
    ],
)
def test_tangents_are_unit_vectors_whatever_the_texture_coordinates(quad, uv):
    found = world_tangents(thing(quad(uv=uv)))
    assert np.isfinite(found).all() and np.allclose(np.linalg.norm(found[:, :3], axis=1), 1)
    assert set(found[:, 3]) <= {-1.0, 1.0}
    if uv[1] == [0, 1]:
        assert np.allclose(found, [0, -1, 0, 1])
    if uv[0] == [1, 0]:
        assert np.allclose(found, [-1, 0, 0, -1])


@pytest.mark.parametrize("kind", ["ply", "glb"])
def test_vertices_carry_numbers_and_texture_coordinates(quad, kind):
    prefix, uv = "_" if kind == "glb" else "", [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]
    values = np.float32([0.1, 0.2, 0.3, 0.4])
    found = load_mesh(quad(kind, uv=uv, **{f"{prefix}roughness": values})).carried
    order = np.argsort(found["roughness"][:, 0])
    assert np.allclose(np.sort(found["roughness"][:, 0]), values)
    assert np.allclose(found["uv"][order], uv, atol=1e-6)


def test_colours_in_bytes_are_shares_of_255(tmp_path):
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    colours = [[255, 0, 0], [0, 51, 0], [0, 0, 102]]
    trimesh.Trimesh(corners, [[0, 1, 2]], vertex_colors=colours, process=False).export(
        tmp_path / "c.ply"
    )
    found = load_mesh(str(tmp_path / "c.ply")).carried["albedo"]
    assert np.allclose(found, np.array(colours) / 255)


def test_split_vertices_stay_apart_and_share_their_normal(tmp_path):
    box = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n" + "".join(f"vt {k / 9} 0\n" for k in range(9))
    box += "f 1/1 3/2 2/3\nf 1/4 2/5 4/6\nf 1/7 4/8 3/9\n"
    (tmp_path / "seams.obj").write_text(box)
    mesh = load_mesh(str(tmp_path / "seams.obj"))
    assert len(mesh.vertices) == 9 == len(mesh.carried["uv"])
    origin = np.abs(mesh.vertices).max(axis=1) == 0
    assert origin.sum() == 3 and np.ptp(mesh.normals[origin], axis=0).max() < 1e-6
    assert np.allclose(mesh.normals[origin][0], -(3**-0.5), atol=1e-6)


@pytest.mark.parametrize(("depth", "off"), [("uint8", 1 / 500), ("uint16", 1e-5)])
def test_albedo_is_decoded_by_the_srgb_curve_and_numbers_are_not(picture, depth, off):
    path = picture("half.png", np.full((2, 2, 3), 0.5), depth)
    assert load_texture(path, "albedo")[0, 0, 0] == pytest.approx(0.2140, abs=2 * off + 1e-4)
    assert load_texture(path, "roughness")[0, 0, 0] == pytest.approx(0.5, abs=off)


def test_row_0_of_a_texture_is_the_lower_edge_of_the_picture(picture):
    path = picture("rows.exr", np.array([[0.25], [0.75]]).repeat(3, axis=1), "float")
    assert load_texture(path, "roughness")[:, 0, 0].tolist() == [0.75, 0.25]


def test_a_normal_map_gives_slopes(picture):
    n = np.array([0.6, 0.0, 0.8])
    path = picture("n.exr", (np.tile(n, (1, 1, 1)) + 1) / 2, "float")
    assert np.allclose(load_texture(path, "normal"), [[[0.75, 0.0]]], atol=1e-6)


@pytest.mark.parametrize(
    ("pixels", "name", "said"),
    [
        ([[[0.5, np.nan, 0.5]]], "albedo", "outside of [0, 1] (or are NaN), first at row 0"),
        ([[[0.5, 1.5, 0.5]]], "roughness", "1 values lie outside"),
        ([[[0.5, 0.5, 0.5]]], "normal", "1 normals point into the surface"),
    ],
)
def test_bad_values_are_refused_in_one_line(picture, refused, pixels, name, said):
    path = picture("bad.exr", np.array(pixels), "float")
    refused(lambda: load_texture(path, name), str(path), name, said)


def test_other_files_are_refused_in_one_line(tmp_path, refused):
    (tmp_path / "a.jpg").write_bytes(b"x")
    (tmp_path / "a.png").write_bytes(b"no png")
    refused(lambda: load_texture(tmp_path / "a.jpg", "albedo"), "unknown format", "use .png")
    refused(lambda: load_texture(tmp_path / "a.png", "albedo"), "cannot be read")
    refused(lambda: load_texture(tmp_path / "none.png", "albedo"), "no such file")


def test_what_a_mesh_lacks_is_told_in_one_line(picture, quad, refused):
    path = str(picture("a.png", np.ones((1, 1, 3))))
    refused(lambda: surface(thing("sphere", {"albedo": path})), "no texture coordinates", "unwrap")
    refused(lambda: surface(thing("globe", {"weight": "vertex"})), "carry no weight", "_WEIGHT")
    refused(lambda: surface(thing("globe", {"albedo": "vertex"})), "carry no colour", "COLOR_0")
    bad = quad(roughness=np.float32([0, 1, 2, 0]))
    refused(lambda: surface(thing(bad, {"roughness": "vertex"})), "leaves [0, 1]")
    bad = quad(roughness=np.float32([0, 1, np.nan, 0]))
    refused(lambda: load_mesh(bad), "roughness", "NaN")


def test_the_mean_of_a_map_stands_for_it(picture):
    pixels = np.array([[[1.0], [0.5]]])
    maps = {"roughness": str(picture("r.exr", pixels.repeat(3, 2), "float"))}
    obj = thing("globe", maps, roughness=0.8)
    assert plain(obj).roughness == pytest.approx(0.8 * ((1 + 1 / 16) / 2) ** 0.25)
    assert not plain(obj).varies
    assert finest_alpha(obj) == pytest.approx(0.16)


def test_a_picture_is_found_by_name_and_beside_the_file_that_names_it(
    tmp_path, write_suite, picture, refused
):
    here = picture("own.png", np.ones((1, 1, 3)))
    material = 'material = { use = "iron", maps = { roughness = "own.png", normal = "%s" } }'
    suite = write_suite('material = "copper"', material % "hammered_normal")
    (entry,) = expand(*load_suite(str(suite)))
    maps = entry.case.objects[0].material.maps
    assert maps.roughness == str(here) and maps.normal.endswith("textures/hammered_normal.png")
    suite = write_suite('material = "copper"', material % "nothing")
    refused(lambda: expand(*load_suite(str(suite))), "object.0.material.maps.normal", "use one of")
    suite = write_suite('material = "copper"', material % "vertex")
    refused(lambda: expand(*load_suite(str(suite))), "picture")
