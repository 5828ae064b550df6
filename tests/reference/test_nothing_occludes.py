"""Where nothing can occlude, no shadow ray is traced, and the truths stay what they are."""

import numpy as np
import pytest
import trimesh

from reference.transport import model_light
from reference.truths import nothing_occludes, stage
from scenes.schema import Camera, Case, Environment, Object
from scenes.suite import HERE
from tests.reference.cases import metal, plastic


def case_of(*meshes, material=None):
    objects = [
        Object(name=f"o{k}", mesh=mesh, material=material or metal(0.4), position=(3.0 * k, 0, 0))
        for k, mesh in enumerate(meshes)
    ]
    path = HERE / "environments" / "studio.exr"
    return Case(
        id="alone",
        scene="alone",
        environment=Environment(name="studio", path=path),
        camera=Camera(origin=(1, -4, 2), target=(0, 0, 0), fov=30),
        width=32,
        height=24,
        objects=objects,
    )


@pytest.fixture
def box(tmp_path):
    """A box whose corners are split, each with its face's normal."""
    made = trimesh.creation.box()
    faces = trimesh.Trimesh(
        made.triangles.reshape(-1, 3), np.arange(36).reshape(-1, 3), process=False
    )
    faces.vertex_normals = np.repeat(made.face_normals, 3, axis=0)
    faces.export(tmp_path / "box.ply", vertex_normal=True)
    return str(tmp_path / "box.ply")


@pytest.fixture
def step(tmp_path):
    """Two faces that see each other."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [0, 1, 1.0]])
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 5], [0, 5, 4]])
    made = trimesh.Trimesh(vertices, faces, process=False)
    split = trimesh.Trimesh(
        made.triangles.reshape(-1, 3), np.arange(12).reshape(-1, 3), process=False
    )
    split.vertex_normals = np.repeat(made.face_normals, 3, axis=0)
    split.export(tmp_path / "step.ply", vertex_normal=True)
    return str(tmp_path / "step.ply")


def test_only_one_flat_or_convex_object_with_its_own_normals_is_free(box, step):
    assert nothing_occludes(case_of("plane")) and nothing_occludes(case_of(box))
    assert not nothing_occludes(case_of(step))
    assert not nothing_occludes(case_of(box, box))
    assert not nothing_occludes(case_of("sphere"))  # its normals are interpolated


@pytest.mark.parametrize("material", [metal(0.4), plastic()])
def test_every_truth_is_what_it_is_with_all_rays_traced(box, material):
    case = case_of(box, material=material)
    short = stage(case, "model")
    assert short.light is not model_light
    object.__setattr__(full := stage.__wrapped__(case, "model"), "light", model_light)
    seen = {}
    for name, one in (("short", short), ("full", full)):
        batches = [one.trace(16, seed) for seed in range(16)]
        for truth in ("unoccluded", "direct", "global", "global.diffuse"):
            energy = [b[truth][one.traced].mean() for b in batches]
            seen[name, truth] = np.mean(energy), np.std(energy, ddof=1) / 4
    for truth in ("unoccluded", "direct", "global", "global.diffuse"):
        (a, a_se), (b, b_se) = seen["short", truth], seen["full", truth]
        # Wrong once in 10,000 over all 8 comparisons, by Student's t with 30 degrees of freedom.
        assert abs(a - b) <= 4.9 * np.hypot(a_se, b_se) + 1e-9
