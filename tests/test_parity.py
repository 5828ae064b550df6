"""Parity: the two sides provably draw the same thing."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
import trimesh
from scipy import ndimage

from reference.batches import PathTracer
from renderer.draw import Renderer
from renderer.techniques import technique
from reports.compare import Truth, exposures_of
from reports.metrics.energy import energy_error
from reports.metrics.subject import Subject
from scenes.schema import Camera, Case, Environment, Material, Object
from scenes.suite import expand, load_suite

MIRROR = Material(name="mirror", roughness=0.0, metallic=1.0, metal=(0.9, 0.8, 0.7))
MATTE = Material(name="matte", roughness=1.0, metallic=0.0, albedo=(0.8, 0.5, 0.2))
SIZE = 96


def write_map(path: Path, radiance: np.ndarray) -> Path:
    height, width = radiance.shape[:2]
    image = oiio.ImageOutput.create(str(path))
    image.open(str(path), oiio.ImageSpec(width, height, 3, oiio.FLOAT))
    image.write_image(np.ascontiguousarray(radiance, np.float32))
    image.close()
    return path


def case_of(path: Path, material: Material, mesh: str = "sphere", rotation: float = 30.0) -> Case:
    return Case(
        id=path.stem,
        scene="parity",
        environment=Environment(name=path.stem, path=path, rotation=rotation),
        camera=Camera(origin=(1.0, -6.0, 1.5), target=(0.1, 0.0, 0.05), fov=24.0),
        width=SIZE,
        height=SIZE - 16,
        objects=(Object(name="thing", mesh=mesh, material=material),),
    )


def ours(case: Case, samples: int = 64, filtered: bool = False) -> np.ndarray:
    """The renderer at its best: `samples` directions at each of 16 points in a pixel."""
    exact = replace(technique(f"sampled@{16 * samples}"), msaa=0, supersample=4, filtered=filtered)
    return Renderer(exact, repeats=0).render(case).rgb


@pytest.fixture
def blobs(tmp_path):
    """A smooth environment without any symmetry, so that no flip or turn looks alike."""
    v, u = np.mgrid[:128, :256] / np.array([128, 256])[:, None, None]
    spots = [(0.1, 0.2, 0.04, 5), (0.35, 0.6, 0.05, 3), (0.6, 0.85, 0.05, 4), (0.85, 0.4, 0.06, 2)]
    radiance = np.full((128, 256, 3), 0.1)
    for number, (row, column, width, peak) in enumerate(spots):
        around = np.minimum(np.abs(u - column), 1 - np.abs(u - column))
        spot = peak * np.exp(-((v - row) ** 2 + around**2) / (2 * width**2))
        radiance += spot[..., None] * np.roll([1.0, 0.6, 0.3], number)
    return write_map(tmp_path / "blobs.exr", radiance)


def best_shift(a: np.ndarray, b: np.ndarray, where: np.ndarray) -> tuple[int, int]:
    """The whole-pixel shift of `a` that comes closest to `b`."""
    shifts = [(dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)]
    return min(shifts, key=lambda s: np.abs(np.roll(a, s, axis=(0, 1)) - b)[where].mean())


def test_background_and_mirror_align_to_a_pixel(blobs):
    case = case_of(blobs, MIRROR)
    truth = PathTracer("unoccluded", 64, 1).render(case)
    picture = ours(case, 16)
    for where in (truth.ids == 0, ndimage.binary_erosion(truth.ids == 1, iterations=2)):
        assert best_shift(picture, truth.rgb, where) == (0, 0)
        off = np.abs(picture - truth.rgb)[where] / truth.rgb[where].mean()
        assert np.median(off) < 0.01
        assert off.mean() < 0.02


def test_masks_are_the_same(blobs):
    case = case_of(blobs, MATTE)
    truth = PathTracer("unoccluded", 16, 1).render(case)
    frame = Renderer(technique("paper"), repeats=0).render(case)
    assert (frame.ids != truth.ids).sum() <= 2  # rays and rasterisation round a tie differently


@pytest.mark.parametrize("material", [MIRROR, MATTE], ids=lambda m: m.name)
def test_a_furnace_is_a_furnace_on_both_sides(tmp_path, material):
    path = write_map(tmp_path / "white.exr", np.ones((16, 32, 3)))
    case = case_of(path, material)
    truth = PathTracer("unoccluded", 256, 1).render(case)
    core = ndimage.binary_erosion(truth.ids == 1, iterations=2)
    picture = ours(case)
    assert picture[core].mean(axis=0) == pytest.approx(truth.rgb[core].mean(axis=0), rel=0.003)
    if material is MIRROR:  # no diffuse part, no masking: what comes back is F
        middle = ndimage.binary_erosion(core, iterations=18)
        assert picture[middle].mean(axis=0) == pytest.approx((0.9, 0.8, 0.7), rel=0.005)


def test_a_one_texel_sun_lands_in_the_same_place_with_the_same_energy(tmp_path):
    radiance = np.zeros((32, 64, 3))
    radiance[9, 40] = 2000.0
    case = case_of(write_map(tmp_path / "sun.exr", radiance), MATTE)
    truth = PathTracer("unoccluded", 256, 1).render(case)
    picture = ours(case, 512)
    on = truth.ids == 1
    assert picture[on].sum() == pytest.approx(truth.rgb[on].sum(), rel=0.01)
    centres = [
        ndimage.center_of_mass(np.where(on, p.mean(axis=2), 0)) for p in (picture, truth.rgb)
    ]
    assert centres[0] == pytest.approx(centres[1], abs=0.2)


def test_normals_that_face_away_are_black_on_both_sides(blobs, tmp_path):
    """A sheet that faces the eye, with normals that turn from it (right) to away from it (left)."""
    corners = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], float)
    normals = np.array([[-0.6, 0.8, 0], [0, -1, 0], [0, -1, 0], [-0.6, 0.8, 0]], float)
    sheet = trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], vertex_normals=normals, process=False)
    sheet.export(tmp_path / "sheet.ply", vertex_normal=True)
    case = case_of(blobs, MATTE, str(tmp_path / "sheet.ply"))
    truth = PathTracer("unoccluded", 64, 1).render(case)
    on = ndimage.binary_erosion(truth.ids == 1, iterations=2)
    black = [p.sum(axis=2)[on] == 0 for p in (ours(case), truth.rgb)]
    assert 0.2 < black[1].mean() < 0.8
    assert (black[0] != black[1]).mean() < 0.01


def assert_energy_agrees(case: Case, samples: int) -> None:
    """`sampled` meets `unoccluded` within the interval, at most 0.3 %, on every object.

    Filtered look-ups catch a small sun without noise; across a horizon they blur it away. On a
    curved object that averages out, on a plane it does not (-0.4 % under a sun 3 degrees up), so
    planes are drawn without the filter.
    """
    curved = ours(case, samples, filtered=True)
    flat = ours(case, samples) if any(o.mesh == "plane" for o in case.objects) else curved
    batches = [PathTracer("unoccluded", 4 * samples, seed).render(case) for seed in range(8)]
    truth = Truth(case, "unoccluded", batches, exposures_of(case, batches))
    for name, view in truth.views.items():
        mesh = case.objects[case.index(name) - 1].mesh
        picture = flat if mesh == "plane" else curved
        off = energy_error(Subject(picture[truth.crops[name]], view))
        low, high = off.interval()
        assert low <= 0.003 and high >= -0.003, (name, off)
        assert (high - low) / 2 < 0.003, (name, off)


DEFAULT = [entry.case for entry in expand(*load_suite("default"))]


def test_sampled_meets_unoccluded_on_spheres():
    """The materials of the first case, half GGX and half Beckmann, on a mesh without detail."""
    case, spheres = DEFAULT[0], []
    for obj in case.objects:
        material = obj.material.model_copy(update={"weight": 0.5})
        spheres.append(obj.model_copy(update={"mesh": "sphere", "material": material}))
    size = {"width": case.width // 4, "height": case.height // 4, "objects": tuple(spheres)}
    assert_energy_agrees(case.model_copy(update=size), 128)


@pytest.mark.long
@pytest.mark.parametrize("case", DEFAULT, ids=lambda c: c.id)
def test_sampled_meets_unoccluded_on_every_material_and_weight_of_the_default_suite(case):
    assert_energy_agrees(case, 128)
