"""The camera's axes, and what its rays see: geometry alone, without either renderer."""

from functools import lru_cache

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from scenes.mesh import world_mesh
from scenes.schema import Camera, Case


def axes(camera: Camera) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Right, up and forward as unit vectors (3,) in world space."""
    forward = _unit(np.subtract(camera.target, camera.origin, dtype=float))
    right = _unit(np.cross(forward, camera.up))
    return right, np.cross(right, forward), forward


def camera_to_world(camera: Camera) -> np.ndarray:
    """The camera's pose, (4, 4): it looks along its own -z with y up, as in glTF and Blender."""
    right, up, forward = axes(camera)
    matrix = np.eye(4)
    matrix[:3] = np.column_stack([right, up, -forward, camera.origin])
    return matrix


def half_extents(case: Case) -> tuple[float, float]:
    """Half the width and height of the image plane at distance 1."""
    tangent = np.tan(np.radians(case.camera.fov) / 2)
    return tangent * case.width / case.height, tangent


@lru_cache(maxsize=4)
def seen_objects(case: Case) -> np.ndarray:
    """The object at each pixel's centre, (H, W) uint8, read-only, 1-based; 0 is the background.

    By rays (Embree), so that pictures from outside can be measured where nothing draws.
    """
    eye = np.array(case.camera.origin)
    meshes = [world_mesh(o) for o in case.objects]
    # Seen from the eye and of size 1: float32 holds what is near as well as what is far.
    corners = [(m.vertices - eye)[m.faces] for m in meshes]
    unit = max(np.abs(c).max() for c in corners)
    scene = EmbreeScene(robust=True)
    _kept = TriangleMesh(scene, (np.concatenate(corners) / unit).astype(np.float32))
    rays = _pixel_rays(case).reshape(-1, 3)
    found = scene.run(np.zeros_like(rays), rays)
    owner = np.repeat(np.arange(1, len(meshes) + 1), [len(m.faces) for m in meshes])
    ids = np.where(found >= 0, owner[found], 0)
    ids = ids.astype(np.uint8).reshape(case.height, case.width)
    ids.flags.writeable = False
    return ids


def _pixel_rays(case: Case) -> np.ndarray:
    """Directions through the pixels' centres, (H, W, 3) float32, row 0 on top."""
    right, up, forward = axes(case.camera)
    wide, high = half_extents(case)
    x = ((np.arange(case.width) + 0.5) / case.width * 2 - 1) * wide
    y = (1 - (np.arange(case.height) + 0.5) / case.height * 2) * high
    rays = forward + x[None, :, None] * right + y[:, None, None] * up
    return rays.astype(np.float32)


def _unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v)
