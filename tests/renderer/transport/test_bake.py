"""What is baked at vertices, once a scene."""

import numpy as np
import pytest
import trimesh

from renderer.probe import probe
from renderer.transport import stored
from renderer.transport.directions import cell_directions, cell_shares, cells_around
from renderer.transport.placed import placed_meshes
from renderer.transport.rows import size_of
from renderer.transport.scene import SIGHT_BITS, TOGETHER, _sights, scene_geometry
from renderer.transport.tessellation import tessellate
from renderer.transport.visibility import (
    FLUX,
    MOST_VERTICES,
    NOBODY,
    PER_SEEN,
    SEEN,
    SIDE,
    VERTEX,
    WITNESSES,
    Visibility,
    bake,
)
from scenes.errors import InputError
from scenes.mesh import world_mesh
from scenes.schema import Camera, Material
from scenes.suite import HERE

WHITE = Material(albedo=(1.0, 1.0, 1.0), f0=0.0, roughness=0.5, metallic=0.0)
GREY = Material(albedo=(0.5, 0.5, 0.5), f0=0.0, roughness=0.5, metallic=0.0)
ABOVE = Camera(origin=(0, -4, 4), target=(0, 0, 0), fov=40)


def test_cells_are_the_same_in_glsl():
    directions = cell_directions(SIDE, SEEN)
    cells = np.arange(SIDE * SIDE)
    files = ("octahedral.glsl",)
    found = probe("vec4(octahedral_cell(d.xyz))", {"d": directions}, files)[:, 0]
    np.testing.assert_array_equal(found, cells)
    middles = probe("vec4(octahedral_direction(int(i.x)), 0.0)", {"i": cells}, files)[:, :3]
    np.testing.assert_allclose(middles, directions, atol=1e-6)
    coarse = probe("vec4(coarse_direction(int(i.x)), 0.0)", {"i": np.arange(SEEN**2)}, files)
    means = directions.reshape(SEEN**2, PER_SEEN, 3).mean(axis=1)
    means /= np.linalg.norm(means, axis=1, keepdims=True)
    assert (means * coarse[:, :3]).sum(axis=1).min() > np.cos(0.1)


def test_cells_cover_the_sphere_by_their_shares():
    weights, d = cell_shares(SIDE, SEEN), cell_directions(SIDE, SEEN)
    np.testing.assert_allclose(weights @ d, 0, atol=1e-6)
    np.testing.assert_allclose(weights @ d**2, 1 / 3, atol=2e-3)


def test_the_cells_around_a_cell_hold_its_neighbours_on_all_sides():
    d, near = cell_directions(SIDE, SEEN), cells_around(SIDE, SEEN)
    for cell in range(0, SIDE * SIDE, 7):
        aside = d[near[cell]] - d[cell]
        outer = np.linalg.norm(aside, axis=1) > 1e-6
        tangent = np.linalg.svd(d[cell][None])[2][1:]
        angles = np.sort(np.arctan2(*(aside[outer] @ tangent.T).T))
        assert np.diff(np.append(angles, angles[0] + 2 * np.pi)).max() < np.radians(100)


def test_long_edges_are_halved_near_others_and_nothing_cracks(ball_and_plate):
    ball, plate = tessellate(ball_and_plate)
    for made, area in ((ball, np.pi), (plate, 16)):
        mesh = trimesh.Trimesh(made.vertices, made.faces, process=False)
        assert mesh.area == pytest.approx(area, rel=1e-3)
    mesh = trimesh.Trimesh(plate.vertices, plate.faces, process=False)
    # A crack would be an edge of one triangle inside of the plate.
    single = mesh.edges[trimesh.grouping.group_rows(mesh.edges_sorted, require_count=1)]
    rim = np.abs(plate.vertices[single]).max(axis=2)
    np.testing.assert_allclose(rim, 2, atol=1e-12)
    lengths, middles = mesh.edges_unique_length, mesh.vertices[mesh.edges_unique].mean(axis=1)
    under = np.linalg.norm(middles[:, :2], axis=1) < 0.2
    far = np.linalg.norm(middles[:, :2], axis=1) > 1.8
    assert lengths[under].max() < 0.75 * lengths[far].max()
    np.testing.assert_array_equal(plate.normals, np.tile([0, 0, 1], (len(plate.normals), 1)))


def test_surfaces_that_coincide_are_not_halved_without_end(light, make_case, monkeypatch):
    monkeypatch.setattr("renderer.transport.tessellation.MOST_VERTICES", 5000)
    for made in tessellate(make_case(light(1.0), *[("plane", GREY, {})] * 2)):
        assert 100 < len(made.vertices) <= 5000


def test_the_plate_sees_as_much_of_the_ball_as_a_cone_holds(ball_and_plate):
    objects = tessellate(ball_and_plate)
    found = bake(objects)
    first = len(objects[0].vertices)
    nearest = first + np.argmin(np.linalg.norm(objects[1].vertices, axis=1))
    free = np.unpackbits(found.open[nearest].view(np.uint8), bitorder="little") > 0
    d = cell_directions(SIDE, SEEN)
    beside = d[:, 2] < np.sqrt(1 - 0.5**2)  # the ball's rim, seen from below, at 30 degrees
    upper = d[:, 2] > 0
    np.testing.assert_array_equal(free[upper], beside[upper])
    assert not free[d[:, 2] < -0.1].any() and free[~upper].any()
    # Form factor of a ball over a plate: (radius / distance)².
    through = found.flux[nearest].sum(axis=0) * FLUX
    np.testing.assert_allclose(through, [1 - 0.25, 0.25], atol=0.03)  # the rim cuts cells
    clear = np.unpackbits(found.clear[nearest].view(np.uint8), bitorder="little") > 0
    assert 0 < clear.sum() < free.sum() and not (clear & ~free).any()


def test_witnesses_stand_where_they_are_seen(ball_and_plate):
    objects = tessellate(ball_and_plate)
    found = bake(objects)
    vertices = np.concatenate([t.vertices for t in objects])
    observer, _ = np.nonzero(found.seeing)
    some = np.arange(0, len(observer), 97)
    entry = found.sights[some]
    there = entry != NOBODY
    apart = vertices[np.where(there, entry & VERTEX, 0)] - vertices[observer[some], None]
    cells = np.where(there, entry >> 22, 0)
    cosine = (apart * cell_directions(SIDE, SEEN)[cells]).sum(axis=2)
    cosine /= np.linalg.norm(apart, axis=2)
    assert np.median(cosine[there]) > np.cos(0.05) and cosine[there].min() > np.cos(0.7)


def test_what_no_texture_of_the_device_holds_is_refused():
    assert size_of(MOST_VERTICES * SEEN**2)[1] <= 16_384
    with pytest.raises(InputError, match="simplify a mesh"):
        size_of(1 << 34)


def test_sights_stand_vertex_by_vertex_in_whole_groups():
    rng = np.random.default_rng(3)
    seeing = rng.random((40, SEEN**2)) < rng.random((40, 1)) ** 3
    seeing[7] = False
    told = rng.integers(0, 1 << 31, (seeing.sum(), WITNESSES), dtype=np.uint32)
    some = np.zeros(0)
    free = rng.random((40, SEEN**2, PER_SEEN)) < 0.5
    bits = np.packbits(free.reshape(40, -1), axis=1, bitorder="little").view(np.uint32)
    found, index, owner = _sights(Visibility(bits, some, some, seeing, told))
    told_open = index >> SIGHT_BITS & 1 << np.arange(PER_SEEN) > 0
    np.testing.assert_array_equal(told_open, free.reshape(-1, PER_SEEN))
    sight = index[:, 0] & (1 << SIGHT_BITS) - 1
    np.testing.assert_array_equal(found[sight[seeing.ravel()]], told)
    assert (sight[~seeing.ravel()] == (1 << SIGHT_BITS) - 1).all()
    groups = owner.reshape(-1, TOGETHER)
    assert (groups == groups[:, :1]).all() and (np.diff(owner[:, 0].astype(int)) >= 0).all()
    assert np.isin(found[:, 0], told[:, 0]).all()  # what fills a group up is real


def test_cases_of_one_geometry_share_it(ball_and_plate):
    """A sweep of materials, lights or cameras loads and uploads it once."""
    other = [o.model_copy(update={"material": WHITE}) for o in ball_and_plate.objects]
    changed = {"id": "other", "objects": tuple(other), "camera": ABOVE, "width": 31}
    assert scene_geometry(ball_and_plate.model_copy(update=changed)) is scene_geometry(
        ball_and_plate
    )


def test_what_vertices_carry_is_geometry(light, make_case):
    """Texture coordinates are stored with a bake, as often as the material repeats them."""
    picture = HERE / "textures" / "worn_roughness.png"

    def placement(repeat):
        maps = {"roughness": str(picture), "repeat": repeat}
        worn = Material(roughness=1.0, metallic=1.0, metal="Cu", maps=maps)
        return stored.placement(make_case(light(1.0), ("plane", worn, {})))

    assert placement(1.0) == placement(1.0) != placement(2.0)


def test_more_vertices_than_can_be_baked_are_refused_in_one_line(
    ball_and_plate, refused, monkeypatch
):
    monkeypatch.setattr("renderer.transport.visibility.MOST_VERTICES", 1000)
    refused(lambda: bake(tessellate(ball_and_plate)), "1,000", "without occlusion")


def test_a_sphere_turns_its_normals_by_its_radius(light, make_case):
    balls = (("sphere", GREY, {"scale": s, "position": (2 * s, 0, 0)}) for s in (0.5, 2.0))
    case = make_case(light(1.0), *balls, ("plane", GREY, {}))
    texels = np.frombuffer(placed_meshes(case).maps["positions"].read(), np.float32)
    counts = np.cumsum([len(world_mesh(o).vertices) for o in case.objects])
    small, large, flat = np.split(texels.reshape(-1, 4)[: counts[-1], 3], counts[:-1])
    np.testing.assert_allclose(small, 2.0, rtol=0.01)
    np.testing.assert_allclose(large, 0.5, rtol=0.01)
    assert flat.max() < 1e-6
