"""Caustics traced from the lamps: the same light as from the eye, with less noise."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from scipy.ndimage import binary_erosion

from reference.truths import stage
from scenes.schema import Camera, Object
from tests.reference.cases import metal, plastic

SKY = np.full((32, 64, 3), 0.02)
SKY[5:8, 30:34] = 40.0, 30.0, 20.0  # wide, so that paths from the eye find it too
SUN = np.full((32, 64, 3), 0.2)
SUN[6, 32] = 400.0
EYE = Camera(origin=(0, -6, 4), target=(0, 0, 0.3), fov=28)
SMOOTH, ROUGH = 0.3, 0.5  # roughness; alpha .09 and .25
MATTE = plastic(0.9, (0.8, 0.8, 0.8))
FLOOR = Object(name="floor", mesh="plane", material=MATTE, scale=5)
BALL = Object(name="ball", mesh="sphere", material=metal(0.1), position=(0, 0, 1))
RECEIVERS = {
    "matte": MATTE,
    "rough-metal": metal(ROUGH, f0="Cu"),
    "smooth-metal": metal(SMOOTH, f0="Cu"),
    "smooth-plastic": plastic(SMOOTH, (0.8, 0.8, 0.8)),
}


def leaning(tmp_path):
    """A square with normals aslant, so that f cos seen from the eye is not that of the light."""
    path = tmp_path / "leaning.ply"
    corners = [(-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)]
    normals = np.tile((np.sin(0.4), 0, np.cos(0.4)), (4, 1))
    square = trimesh.Trimesh(corners, [(0, 1, 2), (0, 2, 3)], vertex_normals=normals, process=False)
    square.export(path, vertex_normal=True)
    return str(path)


def before_a_mirror(tmp_path):
    """Every kind of receiver on the floor before a mirror that throws the lamp on it."""
    mesh, material = leaning(tmp_path), RECEIVERS["smooth-metal"]
    wall = {"scale": (4.8, 1.5, 1), "rotate": (90, 0, 0), "position": (0, 0.7, 0.75)}
    yield Object(name="mirror", mesh=mesh, material=material, **wall)
    for k, (name, material) in enumerate(RECEIVERS.items()):
        place = (1.2 * k - 1.8, 0, 0)
        yield Object(name=name, mesh=mesh, material=material, scale=1.2, position=place)


def light(ready, name, count=16):
    """Of each object over batches: mean (objects, 3), and its variance."""
    batches = [ready.trace(64, seed)[name] for seed in range(count)]
    numbers = range(1, ready.ids.max() + 1)
    means = np.array([[b[ready.ids == k].mean(axis=0) for k in numbers] for b in batches])
    return means.mean(axis=0), means.var(axis=0, ddof=1) / count


@pytest.mark.parametrize("name", ["global", "global.diffuse", "physical"])
def test_light_is_that_of_paths_from_the_eye(name, make_case, tmp_path):
    case = make_case(SKY, objects=tuple(before_a_mirror(tmp_path)), camera=EYE)
    ready = stage(case, "physical" if name == "physical" else "model")
    without = replace(ready, caustics=None)
    (found, noise), (expected, other) = (light(r, name) for r in (ready, without))
    spread = np.sqrt(noise + other)
    assert np.all(np.abs(found - expected) <= 4.5 * spread + 1e-6)


def test_a_small_sun_leaves_no_tail(make_case):
    """Mirrored onto a floor by a ball: the ten largest deviations, with and without light paths."""
    ready = stage(make_case(SUN, objects=(FLOOR, BALL), camera=EYE), "model")
    tail, inside = {}, binary_erosion(ready.ids == 1, iterations=2)
    for one in (ready, replace(ready, caustics=None)):
        floor = np.stack([one.trace(16, seed)["global"][inside] for seed in range(16)])
        off = np.square(floor - floor.mean(axis=0)).sum(axis=2)
        tail[one is ready] = np.sort(off.ravel())[-10:].sum() / off.sum()
    assert tail[False] > 0.3 > 5 * tail[True]


def test_a_seed_gives_the_same_bytes(make_case):
    ready = stage(make_case(SKY, objects=(FLOOR, BALL), camera=EYE), "model")
    first, second, other = (ready.trace(16, seed)["global"] for seed in (3, 3, 4))
    assert first.tobytes() == second.tobytes()
    assert first.tobytes() != other.tobytes()


@pytest.mark.parametrize(
    ("sky", "materials", "any_found"),
    [
        (SKY, (metal(SMOOTH), MATTE), True),
        (SKY, (plastic(SMOOTH),), True),
        (SKY, (metal(SMOOTH),), False),
        (SKY, (metal(ROUGH), MATTE), False),
        (0.2, (metal(SMOOTH), MATTE), False),
        (0.0, (metal(SMOOTH), MATTE), False),
    ],
    ids=["both", "one of both lobes", "no rough lobe", "no smooth one", "no lamp", "no light"],
)
def test_light_paths_are_traced_only_where_there_can_be_caustics(
    sky, materials, any_found, make_case
):
    made = tuple(
        Object(name=str(k), mesh="sphere", material=m, position=(2 * k, 0, 0))
        for k, m in enumerate(materials)
    )
    assert (stage(make_case(sky, objects=made), "model").caustics is not None) == any_found
