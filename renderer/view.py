"""The camera as matrices for OpenGL."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache

import numpy as np
from trimesh.triangles import closest_point

from scenes.camera import axes, half_extents
from scenes.mesh import load_mesh, placement
from scenes.schema import Case, Object

FAR_TO_NEAR = 1e-6  # at the least, or 24 bits of depth tell nothing apart


@dataclass(frozen=True, eq=False)
class View:
    """A pinhole camera.

    Attributes:
        to_clip: (4, 4) float64, world to clip space.
        eye, forward: (3,) world position and unit view direction.
        right, up: (3,) half extents of the image plane at distance 1.
    """

    to_clip: np.ndarray
    eye: np.ndarray
    forward: np.ndarray
    right: np.ndarray
    up: np.ndarray


def view(case: Case) -> View:
    """The case's camera, with depth planes that just hold what can be seen."""
    eye = np.asarray(case.camera.origin)
    right, up, forward = axes(case.camera)
    wide, high = half_extents(case)
    near, far = _depth_planes(case, eye, forward, np.hypot(1, np.hypot(wide, high)))
    look = np.eye(4)
    look[:3, :3] = [right, up, -forward]
    look[:3, 3] = -look[:3, :3] @ eye
    lens = np.zeros((4, 4))
    lens[0, 0], lens[1, 1] = 1 / wide, 1 / high
    lens[2, 2:] = (far + near) / (near - far), 2 * far * near / (near - far)
    lens[3, 2] = -1
    return View(lens @ look, eye, forward, right * wide, up * high)


def inside(obj: Object, eye: np.ndarray) -> bool:
    """Whether a world point is in the object's own bounding box, and so may be in the object."""
    low, high = _box(obj.mesh)
    matrix = placement(obj)
    local = np.linalg.solve(matrix[:3, :3], eye - matrix[:3, 3])
    return bool(((local >= low) & (local <= high)).all())


def covered(
    objects: Iterable[Object], camera: View, size: tuple[int, int]
) -> tuple[int, int, int, int]:
    """The part of a picture of `size` (width, height) that objects may touch.

    Returns:
        Left, bottom, width, height in pixels, from the corners of the objects' bounding boxes.
    """
    clip = np.concatenate([corners(o) for o in objects])
    clip = np.hstack([clip, np.ones((len(clip), 1))]) @ camera.to_clip.T
    if (clip[:, 3] <= 0).any():  # behind the eye: what lies between projects anywhere
        return 0, 0, *size
    points = (clip[:, :2] / clip[:, 3:] + 1) / 2 * size
    low = np.clip(np.floor(points.min(axis=0)) - 1, 0, size).astype(int)
    high = np.clip(np.ceil(points.max(axis=0)) + 1, 0, size).astype(int)
    width, height = (int(n) for n in high - low)
    return int(low[0]), int(low[1]), width, height


def _depth_planes(
    case: Case, eye: np.ndarray, forward: np.ndarray, slant: float
) -> tuple[float, float]:
    """Depths, along `forward`, before and behind everything that can be seen.

    Args:
        slant: distance over depth along a ray through a corner of the picture.
    """
    ahead = []
    for obj in case.objects:
        depth = (corners(obj) - eye) @ forward
        if depth.max() > 0:
            ahead.append((depth.min(), depth.max(), obj))
    if not ahead:
        return 1.0, 2.0
    far = 1.01 * max(deepest for _, deepest, _ in ahead)
    near = far
    for nearest, _, obj in ahead:
        if nearest < 1e-3 * far:  # the box is at the eye or around it; the triangles may not be
            nearest = max(nearest, _distance(obj, eye, far) / slant)
        near = min(near, nearest)
    return max(0.99 * near, FAR_TO_NEAR * far), far


def _distance(obj: Object, eye: np.ndarray, unit: float) -> float:
    """From the eye to the object's triangles; worked out in `unit`, to suit trimesh's epsilons."""
    mesh, matrix = load_mesh(obj.mesh), placement(obj)
    points = (mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3] - eye) / unit
    triangles = points[mesh.faces]
    closest = closest_point(triangles, np.zeros((len(triangles), 3)))
    return float(np.linalg.norm(closest, axis=1).min()) * unit


def corners(obj: Object) -> np.ndarray:
    """The corners of the object's own bounding box in world space, (8, 3)."""
    matrix = placement(obj)
    box = np.array(np.meshgrid(*zip(*_box(obj.mesh), strict=True))).reshape(3, -1).T
    return box @ matrix[:3, :3].T + matrix[:3, 3]


@cache
def _box(mesh: str) -> tuple[np.ndarray, np.ndarray]:
    points = load_mesh(mesh).vertices.astype(float)
    return points.min(axis=0), points.max(axis=0)
