"""Meshes: four formats, one array of normals, and where an object stands."""

import numpy as np
import pytest
import trimesh

from scenes.mesh import load_mesh, placement, world_mesh
from scenes.schema import Material, Object

COPPER = Material(roughness=0.5, metallic=1.0, metal="Cu")
FORMATS = ("ply", "obj", "stl", "glb")


def thing(mesh, **fields) -> Object:
    return Object(name="thing", mesh=str(mesh), material=COPPER, **fields)


def triangles(mesh) -> np.ndarray:
    """Corners of every triangle, (m, 9), in an order that depends on the surface alone."""
    corners = mesh.vertices[mesh.faces]
    first = np.lexsort(corners.transpose(2, 0, 1).reshape(3, -1)).argsort().reshape(-1, 3)
    turn = (first.argmin(axis=1)[:, None] + np.arange(3)) % 3
    corners = np.take_along_axis(corners, turn[..., None], axis=1).reshape(-1, 9)
    return corners[np.lexsort(corners.T)]


@pytest.fixture
def knot(tmp_path):
    """A closed surface without symmetry, off the origin, in every format."""
    mesh = trimesh.creation.icosphere(subdivisions=2)
    mesh.vertices *= 1 + 0.3 * np.sin(3 * mesh.vertices[:, [1, 2, 0]]) + [0, 0.2, 0.5]
    mesh.vertices += [3, -2, 1]
    mesh.vertices = np.float32(mesh.vertices)
    for ending in FORMATS:
        mesh.export(tmp_path / f"knot.{ending}", **({"digits": 9} if ending == "obj" else {}))
    return tmp_path


@pytest.mark.parametrize("ending", FORMATS)
def test_every_format_gives_the_same_triangles(knot, ending):
    mesh, ply = load_mesh(str(knot / f"knot.{ending}")), load_mesh(str(knot / "knot.ply"))
    assert mesh.vertices.shape == ply.vertices.shape == (162, 3)
    # Two roundings to float32 of coordinates up to 5.
    np.testing.assert_allclose(triangles(mesh), triangles(ply), atol=1e-6)
    assert mesh.closed


@pytest.mark.parametrize("name", ["sphere", "plane", "knot"])
@pytest.mark.parametrize("scale", [1.0, (3.0, 0.1, 1.0), 1e-6, 1e6], ids=str)
def test_normals_are_unit_and_point_out(knot, name, scale):
    mesh = world_mesh(thing(knot / "knot.stl" if name == "knot" else name, scale=scale))
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-6)
    if name == "knot" and not np.isscalar(scale):
        return  # the mean of normals, once stretched, need not see every face from outside
    corners = mesh.vertices[mesh.faces].astype(float)
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("fj,fkj->fk", faces, mesh.normals[mesh.faces]) > 0).all()


def test_normals_of_a_stretched_sphere_are_those_of_the_ellipsoid():
    axes = np.array([2.0, 0.5, 1.0])
    mesh = world_mesh(thing("sphere", scale=tuple(axes)))
    gradient = mesh.vertices / axes**2
    gradient /= np.linalg.norm(gradient, axis=1, keepdims=True)
    np.testing.assert_allclose(mesh.normals, gradient, atol=1e-5)


def test_a_turn_is_about_x_then_y_then_z():
    mesh = world_mesh(thing("plane", rotate=(90, 0, 90), position=(1, 2, 3)))
    # z goes to -y about x, and on to +x about z.
    np.testing.assert_allclose(mesh.normals, np.tile([1.0, 0, 0], (4, 1)), atol=1e-7)
    np.testing.assert_allclose(mesh.vertices.mean(axis=0), [1, 2, 3], atol=1e-6)


@pytest.mark.parametrize("rotate", [(0, 0, 0), (40, 10, 70)], ids=str)
def test_height_puts_the_middle_of_the_base_on_the_position(knot, rotate):
    mesh = world_mesh(thing(knot / "knot.ply", height=2.5, position=(4, 5, 6), rotate=rotate))
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    np.testing.assert_allclose([*(low + high)[:2] / 2, low[2]], [4, 5, 6], atol=1e-5)
    assert high[2] - low[2] == pytest.approx(2.5, abs=1e-5)


def test_a_flat_mesh_takes_no_height(refused):
    refused(lambda: placement(thing("plane", height=1.0)), "plane", "height", "set 'scale'")


@pytest.mark.parametrize(
    "fields",
    [
        {"scale": 1e-16},
        {"scale": 2e15},
        {"scale": (1.0, 1e-16, 1.0)},
        {"position": (0.0, 2e15, 0.0)},
        {"height": 1e-16},
        {"height": 1e300},
    ],
    ids=str,
)
def test_an_object_whose_squares_leave_float32_is_refused(refused, fields):
    refused(lambda: placement(thing("sphere", **fields)), "sphere", "scale", "thing", "keep")


@pytest.mark.parametrize("scale", [1e-15, 1e-6, 1e6, 9e14])
def test_objects_of_any_other_size_are_placed(scale):
    assert np.isfinite(placement(thing("sphere", scale=scale))).all()


def test_closed_meshes_are_recognised(tmp_path):
    box = trimesh.creation.box()
    box.export(tmp_path / "box.ply")
    box.update_faces(np.arange(len(box.faces)) > 0)
    box.export(tmp_path / "open.ply")
    assert load_mesh("sphere").closed and load_mesh(str(tmp_path / "box.ply")).closed
    assert not load_mesh("plane").closed and not load_mesh(str(tmp_path / "open.ply")).closed


@pytest.mark.parametrize("ending", ["ply", "obj", "glb"])
def test_stored_normals_are_kept_where_vertices_are_split(tmp_path, ending):
    box = trimesh.creation.box()
    box.unmerge_vertices()
    box = trimesh.Trimesh(
        box.vertices,
        box.faces,
        vertex_normals=np.repeat(box.face_normals, 3, axis=0),
        process=False,
    )
    options = {"vertex_normal" if ending == "ply" else "include_normals": True}
    box.export(tmp_path / f"flat.{ending}", **options)
    mesh = load_mesh(str(tmp_path / f"flat.{ending}"))
    assert len(mesh.vertices) >= 24 and mesh.closed
    np.testing.assert_allclose(np.abs(mesh.normals).max(axis=1), 1, atol=1e-7)


def test_stored_normals_win_over_those_of_the_faces(tmp_path):
    (tmp_path / "leaf.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0.6 0 0.8\nvn 0 0 3\nf 1//1 2//2 3//2\n"
    )
    mesh = load_mesh(str(tmp_path / "leaf.obj"))
    np.testing.assert_allclose(sorted(mesh.normals[:, 0].tolist()), [0, 0, 0.6], atol=1e-6)


@pytest.mark.parametrize("ending", ["ply", "obj", "glb"])
def test_parts_stand_where_the_file_puts_them(tmp_path, ending):
    scene, ball = trimesh.Scene(), trimesh.creation.icosphere(subdivisions=2)
    ball.vertex_normals  # noqa: B018 - asked for once, they are stored too
    mirror = np.diag([-1.0, 1, 1, 1])
    scene.add_geometry(ball, transform=trimesh.transformations.translation_matrix([5, 0, 0]))
    scene.add_geometry(
        ball, transform=trimesh.transformations.translation_matrix([0, 9, 0]) @ mirror
    )
    (scene if ending == "glb" else scene.to_mesh()).export(tmp_path / f"two.{ending}")
    mesh = load_mesh(str(tmp_path / f"two.{ending}"))
    assert mesh.closed and len(mesh.faces) == 640
    np.testing.assert_allclose(mesh.vertices.min(axis=0), [-1, -1, -1], atol=1e-6)
    np.testing.assert_allclose(mesh.vertices.max(axis=0), [6, 10, 1], atol=1e-6)
    middles = np.where(mesh.vertices[:, 1:2] > 4, [0.0, 9, 0], [5.0, 0, 0])
    np.testing.assert_allclose(mesh.normals, mesh.vertices - middles, atol=0.02)


def test_a_closed_mesh_inside_out_is_turned(tmp_path):
    for stored in (False, True):
        mesh = trimesh.creation.icosphere(subdivisions=2)
        mesh.invert()
        mesh.export(tmp_path / f"{stored}.ply", vertex_normal=stored)
        loaded = load_mesh(str(tmp_path / f"{stored}.ply"))
        assert loaded.closed
        np.testing.assert_allclose(loaded.normals, loaded.vertices, atol=0.02)
        corners = loaded.vertices[loaded.faces]
        faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert (np.einsum("fj,fj->f", faces, corners.sum(axis=1)) > 0).all()


@pytest.mark.parametrize("size", [1e-9, 1e-6, 1e6, 1e12])
def test_size_does_not_matter(tmp_path, size):
    mesh = trimesh.creation.icosphere(subdivisions=2)
    normals = load_mesh_of(tmp_path, mesh.vertices, mesh.faces, "one").normals
    loaded = load_mesh_of(tmp_path, mesh.vertices * size, mesh.faces, "sized")
    np.testing.assert_allclose(loaded.normals, normals, atol=1e-5)
    assert loaded.closed and len(loaded.vertices) == 162


def load_mesh_of(folder, vertices, faces, name):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(vertices, float).tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (np.asarray(faces) + 1).tolist()]
    (folder / f"{name}.obj").write_text("\n".join(lines))
    return load_mesh(str(folder / f"{name}.obj"))


def test_a_stray_vertex_far_off_changes_nothing(tmp_path):
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    alone = load_mesh_of(tmp_path, corners, [[0, 1, 2]], "alone")
    beside = load_mesh_of(tmp_path, [*corners, [1e12, 0, 0]], [[0, 1, 2]], "beside")
    np.testing.assert_array_equal(beside.vertices, alone.vertices)
    np.testing.assert_array_equal(beside.faces, alone.faces)


def test_triangles_without_area_are_dropped_and_no_normal_is_nan(tmp_path):
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]]
    faces = [[0, 1, 2], [0, 2, 3], [0, 1, 4], [3, 3, 1]]
    mesh = load_mesh_of(tmp_path, square, faces, "square")
    assert len(mesh.faces) == 2
    np.testing.assert_allclose(mesh.normals, np.tile([0.0, 0, 1], (4, 1)))


def test_normals_that_cancel_are_replaced_by_a_face_normal(tmp_path):
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    mesh = load_mesh_of(tmp_path, vertices, [[0, 1, 2], [0, 2, 1]], "leaf")
    np.testing.assert_allclose(np.abs(mesh.normals), np.tile([0.0, 0, 1], (3, 1)))


@pytest.mark.parametrize("normal", ["0 0 0", "nan 0 1"])
def test_stored_normals_without_direction_are_mended(tmp_path, normal):
    (tmp_path / "bad.obj").write_text(
        f"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn {normal}\nvn 0 0 1\nf 1//1 2//2 3//2\n"
    )
    mesh = load_mesh(str(tmp_path / "bad.obj"))
    np.testing.assert_allclose(mesh.normals, np.tile([0.0, 0, 1], (3, 1)))


@pytest.mark.parametrize("ending", FORMATS)
@pytest.mark.parametrize("kept", [0.0, 0.02, 0.3, 0.95])
def test_a_mesh_cut_short_is_refused(knot, refused, ending, kept):
    if ending == "obj" and kept == 0.95:
        pytest.skip("an OBJ does not say how many faces it should have")
    whole = (knot / f"knot.{ending}").read_bytes()
    path = knot / f"cut.{ending}"
    path.write_bytes(whole[: int(len(whole) * kept)])
    refused(lambda: load_mesh(str(path)), path.name, "mesh")


@pytest.mark.parametrize("ending", FORMATS)
def test_a_missing_or_broken_mesh_is_refused(tmp_path, refused, ending):
    path = tmp_path / f"thing.{ending}"
    refused(lambda: load_mesh(str(path)), path.name, "mesh", "name an existing mesh file")
    for content in (b"", b"junk \n" * 50, np.random.default_rng(1).bytes(500)):
        path.write_bytes(content)
        refused(lambda: load_mesh(str(path)), path.name, "mesh", "mesh")


@pytest.mark.parametrize(
    ("text", "field", "remedy"),
    [
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "mesh", "at least one triangle"),
        ("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "faces", "a surface"),
        ("v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "faces", "a surface"),
        ("v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vertices", "export it again"),
        ("v 0 inf 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vertices", "export it again"),
        ("v 0 1e60 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vertices", "export it again"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "mesh", "export it again"),
    ],
    ids=["no faces", "no area", "one point", "NaN", "Inf", "huge", "no such vertex"],
)
def test_a_mesh_without_a_surface_is_refused(tmp_path, refused, text, field, remedy):
    path = tmp_path / "bad.obj"
    path.write_text(text)
    refused(lambda: load_mesh(str(path)), "bad.obj", field, remedy)
