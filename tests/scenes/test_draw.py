"""Cases drawn at random: the same from a seed, sound whatever the seed, and of every kind."""

import hashlib

import numpy as np
import pytest

from renderer.objects import object_ids
from scenes.draw.dice import stream
from scenes.draw.environments import KINDS as ENVIRONMENTS
from scenes.draw.environments import draw_environment
from scenes.draw.materials import draw_material
from scenes.draw.meshes import KINDS as MESHES
from scenes.draw.meshes import draw_mesh
from scenes.draw.noise import noise
from scenes.draw.sphere import Canvas
from scenes.draw.suite import budgets, draw_suite
from scenes.environment import load_environment
from scenes.mesh import load_mesh, world_mesh
from scenes.schema import Material, Model
from scenes.suite import Budget, expand, load_suite

COARSE = 0.01  # of the texels and triangles: what is drawn stays as it is
BASE, _ = load_suite("default")
# Of seed 1's first two cases, decoded: packages may compress files anew. Whoever changes what a
# seed gives changes this too, and says so.
DIGEST = "70d48342cd21e6379b7346ecc2de9fc369d10134d17088f985891101f25c81e2"


def drawn(folder, seed, count=1, base=BASE):
    return expand(*load_suite(str(draw_suite(base, "default", seed, count, folder, COARSE))))


def contents(folder):
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_a_seed_gives_the_same_bytes_again(tmp_path):
    drawn(tmp_path / "a", 5, 3)
    drawn(tmp_path / "b", 5, 3)
    assert contents(tmp_path / "a") == contents(tmp_path / "b")


def test_a_case_is_the_same_however_many_are_drawn(tmp_path):
    drawn(tmp_path / "few", 5, 2)
    drawn(tmp_path / "many", 5, 4)
    few, many = contents(tmp_path / "few"), contents(tmp_path / "many")
    shared = {p for p in few if len(p.parts) > 1}
    assert len(shared) > 8 and all(few[p] == many[p] for p in shared)


def test_a_seed_gives_the_same_on_every_machine(tmp_path):
    drawn(tmp_path, 1, 2)
    digest = hashlib.sha256()
    for path in sorted(tmp_path.rglob("*.*")):
        if path.suffix == ".exr":
            digest.update(load_environment(path).radiance.tobytes())
        elif path.suffix == ".ply":
            digest.update(load_mesh(str(path)).vertices.tobytes())
        elif path.name != "suite.toml":  # which holds what its base asks
            digest.update(path.read_bytes())
    assert digest.hexdigest() == DIGEST


def test_other_seeds_give_other_cases(tmp_path):
    cases = [drawn(tmp_path / str(seed), seed)[0].case for seed in range(12)]
    assert len({c.camera.origin for c in cases}) == len(cases)
    assert len({o.material.roughness for c in cases for o in c.objects}) > 2 * len(cases)
    assert len({c.environment.path.read_bytes() for c in cases}) == len(cases)


@pytest.fixture(scope="module")
def many(tmp_path_factory):
    """The first case of 200 seeds, and 24 of one seed."""
    folder = tmp_path_factory.mktemp("drawn")
    entries = [e for seed in range(200) for e in drawn(folder / str(seed), seed)]
    return [e.case for e in entries + drawn(folder / "more", 1000, 24)]


def test_nothing_cuts_anything(many):
    for case in many:
        solid = {o.name: world_mesh(o).vertices.astype(float) for o in case.objects}
        floor, wall = solid.pop("floor", None), solid.pop("wall", None)
        bodies = list(solid.values())
        for number, a in enumerate(bodies):
            for b in bodies[:number]:
                # Some upright plane has all of one on either side.
                turns = np.linspace(0, np.pi, 24, endpoint=False)
                across = np.stack([np.cos(turns), np.sin(turns)])
                pa, pb = a[:, :2] @ across, b[:, :2] @ across
                gaps = np.maximum(pa.min(0) - pb.max(0), pb.min(0) - pa.max(0))
                assert gaps.max() > 0, case.id
            if floor is not None:
                assert a[:, 2].min() > -1e-6, case.id
            if wall is not None:
                corner, right, _, up = wall
                normal = np.cross(right - corner, up - corner)
                assert ((a - corner) @ normal).min() > 0, case.id


def test_everything_judged_is_seen_and_small_things_say_so(many):
    unsaid = judged = 0
    for case in many:
        ids = object_ids(case)
        for obj in case.judged:
            pixels = int((ids == case.index(obj.name)).sum())
            assert pixels > 400, (case.id, obj.name)
            judged += 1
            unsaid += pixels < 10_000 and not obj.small
    # The estimate counts cells that an edge crosses as whole.
    assert unsaid <= 0.01 * judged


def test_every_kind_of_thing_is_met(many):
    assert {c.environment.name for c in many} == set(ENVIRONMENTS)
    meshes = {o.mesh.rpartition("/")[2].rstrip(".ply0123456789") for c in many for o in c.objects}
    assert {m.rstrip("4") for m in meshes} >= {
        "sphere",
        "plane",
        *(m.rstrip(".ply") for m in MESHES),
    }
    assert {len([o for o in c.objects if o.mesh != "plane"]) for c in many} == {1, 2, 3, 4}
    materials = [o.material for c in many for o in c.objects]
    assert {0.0, 1.0} < {m.metallic for m in materials}
    assert {0.0, 1.0} < {m.weight for m in materials}
    assert any(m.weight_g is not None and m.weight_g != m.weight for m in materials)
    assert any(m.metal and m.metal.name for m in materials)
    assert any(m.metal and not m.metal.name for m in materials)
    assert min(m.roughness for m in materials) < 0.08 and max(m.roughness for m in materials) > 0.97
    fovs = [c.camera.fov for c in many]
    assert min(fovs) < 12 and max(fovs) > 55


@pytest.mark.parametrize("kind", ENVIRONMENTS)
def test_an_environment_is_light_of_the_mean_of_real_ones(kind):
    for seed in range(8):
        radiance = draw_environment(kind, stream(seed), 0.1)
        height, width, _ = radiance.shape
        assert width == 2 * height and np.isfinite(radiance).all() and radiance.min() >= 0
        assert 0.24 < Canvas(width, height).mean(radiance).mean() < 1.61
        assert radiance.std(axis=(0, 1)).min() > 0.02


@pytest.mark.parametrize("kind", MESHES)
def test_a_mesh_is_closed_and_as_fine_as_asked(kind, tmp_path):
    for seed, triangles in enumerate((500, 2_000, 10_000, 50_000)):
        made = draw_mesh(kind, stream(seed), triangles)
        path = tmp_path / f"{seed}.ply"
        made.export(path, vertex_normal=True)
        mesh = load_mesh(str(path))
        assert mesh.closed and made.volume > 0
        # A gear has 40 a tooth at least.
        assert 0.75 * triangles < len(mesh.faces) < max(1.35 * triangles, 40 * 23)
        assert np.linalg.norm(mesh.vertices, axis=1).max() == pytest.approx(1, abs=1e-5)
        a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
        facing = (np.cross(b - a, c - a) * mesh.normals[mesh.faces].mean(axis=1)).sum(axis=1)
        assert (facing > 0).mean() > 0.999


def test_edges_are_kept_hard(tmp_path):
    made = draw_mesh("gear", stream(3), 5_000)
    path = tmp_path / "gear.ply"
    made.export(path, vertex_normal=True)
    mesh = load_mesh(str(path))
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    across = np.cross(b - a, c - a)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    # Of a smoothed gear the corners' normals are 45 degrees off.
    assert (across[:, None] * mesh.normals[mesh.faces]).sum(axis=2).min() > np.cos(np.radians(20))


def test_noise_has_mean_0_and_deviation_1_at_every_scale():
    points = stream(0).uniform(-40, 40, (20_000, 3))
    for octaves in (1, 5):
        values = noise(stream(1), points, 1.0, octaves)
        assert abs(values.mean()) < 0.05 and abs(values.std() - 1) < 0.05


def test_budgets_are_half_as_wide_again_and_those_of_own_cases_are_left_out():
    rules = (
        Budget(technique="paper", truth="global", energy_error=0.02, energy_local=0.1, ssim=0.98),
        Budget(technique="paper", truth="global", scene="contact", reason="r", energy_local=9.0),
        Budget(technique="sampled", truth="global", energy_error=0.9, silhouette=0.2),
        Budget(technique="sampled@8", truth="global", ssim=0.5),  # asked by a run of its own
        Budget(technique="paper", truth="physical", ssim=0.5),  # of a run with that model
    )
    wide = budgets(BASE.model_copy(update={"budget": rules}))
    told = [r.model_dump(exclude_none=True, exclude={"technique", "truth", "reason"}) for r in wide]
    assert told == [
        {"energy_error": 0.03, "energy_local": 0.15, "ssim": 0.97},
        {"energy_error": 0.999, "silhouette": 0.0},
    ]


def test_physical_is_asked_only_where_every_metal_is_measured(tmp_path):
    entries = drawn(tmp_path, 7, 8)
    bare = [
        any(o.material.metal and not o.material.metal.name for o in e.case.objects) for e in entries
    ]
    assert any(bare) and not all(bare)
    assert [("physical" in e.truths) for e in entries] == [not b for b in bare]


def test_an_exact_model_gets_measured_metals_alone(tmp_path):
    base = BASE.model_copy(update={"model": Model(fresnel="exact")})
    for entry in drawn(tmp_path, 7, 8, base):
        assert entry.case.model.fresnel == "exact" and "physical" in entry.truths
        assert all(o.material.metal is None or o.material.metal.eta for o in entry.case.objects)


def test_every_material_is_valid():
    for seed in range(300):
        _, fields = draw_material(stream(seed), measured=False)
        assert Material(**fields).source == "drawn at random"
