"""The camera as matrices for OpenGL."""

from dataclasses import dataclass

import numpy as np

from scenes.schema import Case


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


def view(case: Case, points: np.ndarray) -> View:
    """The case's camera, with depth planes that just hold the world points (n, 3)."""
    camera = case.camera
    eye = np.asarray(camera.origin)
    forward = _unit(np.asarray(camera.target) - eye)
    right = _unit(np.cross(forward, camera.up))
    up = np.cross(right, forward)
    tangent = np.tan(np.radians(camera.fov) / 2)
    aspect = case.width / case.height
    depth = (points - eye) @ forward
    far = max(depth.max() * 1.01, 1e-6)
    near = max(depth.min() * 0.99, far * 1e-4)
    look = np.eye(4)
    look[:3, :3] = [right, up, -forward]
    look[:3, 3] = -look[:3, :3] @ eye
    lens = np.zeros((4, 4))
    lens[0, 0], lens[1, 1] = 1 / (tangent * aspect), 1 / tangent
    lens[2, 2:] = (far + near) / (near - far), 2 * far * near / (near - far)
    lens[3, 2] = -1
    return View(lens @ look, eye, forward, right * tangent * aspect, up * tangent)


def _unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v)
