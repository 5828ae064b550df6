"""What surfaces do to one another's light: baked, traced, exchanged."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from renderer.draw import Renderer
from renderer.features import technique
from renderer.precompute import precomputed
from renderer.probe import brdf_values, probe
from renderer.shading import Shading
from renderer.transport import stored
from renderer.transport.bvh import LEAF, build
from renderer.transport.directions import cell_directions, cell_shares, cells_around
from renderer.transport.exchange import MOST_KEPT, _ahead
from renderer.transport.placed import four, placed_meshes
from renderer.transport.rays import Rays
from renderer.transport.rows import holding, size_of
from renderer.transport.scene import SIGHT_BITS, TOGETHER, _loaded, _sights, _tree, scene_geometry
from renderer.transport.tessellation import Tessellation, tessellate
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
from scenes.schema import Camera, Material, Model
from scenes.suite import HERE


def precomputed_maps(case):
    """All maps that `best` reads of a case's environment."""
    made = precomputed(case.environment.path)
    made.need(sorted({m for o in case.objects for m in technique("best").maps(o.material)}))
    return made.maps


WHITE = Material(albedo=(1.0, 1.0, 1.0), f0=0.0, roughness=0.5, metallic=0.0)
GREY = Material(albedo=(0.5, 0.5, 0.5), f0=0.0, roughness=0.5, metallic=0.0)
ABOVE = Camera(origin=(0, -4, 4), target=(0, 0, 0), fov=40)


@pytest.fixture
def _own_bakes(tmp_path, monkeypatch):
    monkeypatch.setattr(stored, "folder", lambda: tmp_path / "bakes")
    _loaded.cache_clear()


@pytest.fixture
def ball_and_plate(light, make_case):
    """A ball over a plate, which it touches nowhere."""
    parts = [("sphere", GREY, {"scale": 0.5, "position": (0, 0, 1.0)})]
    parts += [("plane", WHITE, {"scale": 4.0})]
    return make_case(light(1.0), *parts, camera=ABOVE)


@pytest.fixture
def bowl(tmp_path):
    """A thick bowl that opens upwards, as a file."""
    outside, inside = np.linspace(0, 1.5, 30), np.linspace(1.4, 0, 30)
    profile = np.concatenate(
        [
            np.stack([np.sin(outside), -np.cos(outside)], axis=1),
            0.8 * np.stack([np.sin(inside), -np.cos(inside)], axis=1),
        ]
    )
    path = tmp_path / "bowl.ply"
    trimesh.creation.revolve(profile, sections=64).export(path)
    return str(path)


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


def soup(count):
    rng = np.random.default_rng(7)
    return rng.uniform(-1, 1, (count, 1, 3)) + rng.normal(0, 0.05, (count, 3, 3))


@pytest.mark.parametrize("count", [1, 5, 700])
def test_rays_hit_in_the_shader_what_they_hit_in_embree(count):
    """Embree is asked through the same wrapper that bakes; the tree is that of the shader."""
    triangles = soup(count).astype(np.float32)
    rng = np.random.default_rng(1)
    origins = rng.uniform(-2, 2, (4000, 3)).astype(np.float32)
    directions = triangles[rng.integers(count, size=4000)].mean(axis=1) - origins
    directions[::5, 0] = 0  # along the axes' planes, where 1 / direction is infinite
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    directions = directions.astype(np.float32)
    mesh = Tessellation(
        triangles.reshape(-1, 3).astype(float),
        np.zeros((3 * count, 3), np.float32),
        np.arange(3 * count).reshape(-1, 3),
        np.empty((3 * count, 0), np.float32),
    )
    hits = Rays([mesh], np.zeros(3)).first(origins, directions)
    declared = "vec4 found(Hit h, bool any) { return vec4(h.triangle, h.weights.yz, any); }"
    expression = "found(trace(o.xyz, d.xyz, false), blocked(o.xyz, d.xyz))"
    found = probe(
        expression,
        {"o": origins, "d": directions},
        ("trace.glsl",),
        declarations=declared,
        maps=_tree(triangles),
    )
    same = found[:, 0] == hits.triangle
    assert same.mean() > 0.999  # an edge may go to either side
    assert ((found[:, 3] > 0) == (hits.triangle >= 0)).mean() > 0.999
    hit = same & (hits.triangle >= 0)
    assert hit.any()
    # Triangles seen edge on say little of where they are hit.
    assert np.percentile(np.abs(found[hit, 1] - hits.u[hit]), 99) < 1e-3


def test_every_triangle_stands_in_one_leaf():
    tree = build(soup(700).astype(np.float32))
    held = tree.order[tree.order >= 0]
    assert sorted(held) == list(range(700))
    assert len(tree.nodes) == 2 * len(tree.order) // LEAF - 1
    assert np.isfinite(tree.nodes).all()  # a box at infinity is met by rays that go there


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


def test_a_pixel_knows_where_in_its_triangle_it_lies():
    corners = np.array([[0, 5, 0], [1, 5, 0], [0, 5, 1]], np.float32)
    positions = holding(four(np.float32(corners)), "f4")
    weights = np.array([[0.2, 0.3, 0.5], [0.6, 0.3, 0.1], [1.2, -0.1, -0.1]])
    found = probe(
        "vec4(weights_at(uvec3(0u, 1u, 2u), ray.xyz), 0.0)",
        {"ray": weights @ corners},
        ("place.glsl",),
        uniforms={"eye": (0.0, 0.0, 0.0)},
        maps={"positions": positions},
    )[:, :3]
    weights[2] = 1, 0, 0  # beside the triangle: moved in
    np.testing.assert_allclose(found, weights, atol=1e-6)


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


@pytest.mark.usefixtures("_own_bakes")
def test_a_scene_is_baked_once_and_again_where_its_file_is_damaged(ball_and_plate, monkeypatch):
    made = []
    monkeypatch.setattr("renderer.transport.scene.bake", lambda o: made.append(1) or bake(o))

    def fresh():
        _loaded.cache_clear()
        return scene_geometry(ball_and_plate)

    first, again = fresh(), fresh()
    assert len(made) == 1 and first.first_sight == again.first_sight
    (path,) = stored.folder().iterdir()
    path.write_bytes(path.read_bytes()[:1000])
    assert fresh().first_sight == first.first_sight and len(made) == 2


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


@pytest.mark.usefixtures("_own_bakes")
def test_old_bakes_make_room(ball_and_plate, monkeypatch):
    scene_geometry(ball_and_plate)
    (old,) = stored.folder().iterdir()
    monkeypatch.setattr(stored, "MOST_BYTES", old.stat().st_size + 1000)
    moved = ball_and_plate.objects[0].model_copy(update={"position": (0.0, 0.0, 1.1)})
    scene_geometry(ball_and_plate.model_copy(update={"objects": (moved,)}))
    (new,) = stored.folder().iterdir()
    assert new != old


def test_a_bake_is_known_by_geometry_alone(ball_and_plate, copper):
    ball, plate = ball_and_plate.objects
    other = ball.model_copy(update={"material": copper(0.1), "name": "x", "judged": False})
    moved = ball.model_copy(update={"position": (0.0, 0.0, 1.1)})

    def key(*objects):
        return stored.placement(ball_and_plate.model_copy(update={"objects": objects}))

    assert key(ball, plate) == key(other, plate) != key(moved, plate)


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
