"""The camera's axes, and what its rays see, by hand."""

import numpy as np
import pytest

from scenes.camera import camera_to_world, seen_objects
from scenes.schema import Camera, Case, Environment, Material, Object
from scenes.suite import HERE

COURTYARD = HERE / "environments" / "courtyard.exr"
GREY = Material(albedo=(0.5, 0.5, 0.5), roughness=0.5, metallic=0.0)


def case_of(*objects, size=(96, 64), **camera) -> Case:
    given = {"origin": (0.0, -6.0, 1.4), "target": (0.0, 0.0, 0.5), "fov": 50.0} | camera
    return Case(
        id="seen",
        scene="seen",
        width=size[0],
        height=size[1],
        camera=Camera(**given),
        environment=Environment(name="any", path=COURTYARD),
        objects=tuple(
            Object(name=f"o{k}", mesh=mesh, material=GREY, **place)
            for k, (mesh, place) in enumerate(objects)
        ),
    )


def test_the_camera_looks_along_minus_z_with_its_right_hand_along_x():
    camera = Camera(origin=(0.0, -4.0, 1.0), target=(0.0, 0.0, 1.0), fov=30.0)
    expected = [[1, 0, 0, 0], [0, 0, -1, -4], [0, 1, 0, 1], [0, 0, 0, 1]]
    assert camera_to_world(camera) == pytest.approx(np.array(expected, float))


def test_a_ball_in_the_middle_is_a_disk_of_the_angle_that_it_fills():
    case = case_of(
        ("sphere", {"scale": 1.0}), size=(65, 65), origin=(0.0, -4.0, 0.0), target=(0.0, 0.0, 0.0)
    )
    ids = seen_objects(case)
    off = np.arange(65) - 32
    tangent = np.hypot(off[:, None], off) * np.tan(np.radians(25)) / 32.5
    expected = tangent < np.tan(np.arcsin(1 / 4))
    assert (ids == expected).all()


def test_row_0_is_on_top_and_what_is_nearer_hides_what_is_behind():
    high = ("sphere", {"position": (1.0, 0.0, 1.5), "scale": 0.5})
    near = ("sphere", {"position": (0.0, -2.0, 0.5), "scale": 0.4})
    far = ("sphere", {"position": (0.0, 2.0, 0.5), "scale": 0.6})
    ids = seen_objects(case_of(high, far, near))
    rows, columns = np.nonzero(ids == 1)
    assert rows.mean() < 24 and columns.mean() > 54
    middle = ids[np.nonzero(ids == 3)]
    assert len(middle) > 50 and 2 in ids
    ring = np.nonzero(ids == 2)
    assert abs(ring[1].mean() - np.nonzero(ids == 3)[1].mean()) < 1


@pytest.mark.parametrize("unit", [1, 3e4, 1e-4])
@pytest.mark.parametrize("side", [20, 2e4, 2e5])
def test_small_things_on_a_wide_floor_are_seen_in_any_unit(unit, side):
    camera = {"origin": (0, -6 * unit, 1.4 * unit), "target": (0, 0, unit / 2)}
    ball = ("sphere", {"position": (0, 0, unit), "scale": unit})
    ids = seen_objects(case_of(ball, ("plane", {"scale": side * unit}), **camera))
    plain = seen_objects(case_of(("sphere", {"position": (0, 0, 1.0)}), ("plane", {"scale": 20.0})))
    ball_moved = (ids == 1) != (plain == 1)
    assert ball_moved.sum() <= 2  # the floor cuts it at one point only
    assert (ids[-8:] == 2).all() and not (ids[:8] == 2).any()
