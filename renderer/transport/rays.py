"""Rays against a scene's triangles on the CPU (Embree), for what is baked."""

from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from renderer.transport.tessellation import Tessellation


@dataclass(frozen=True, eq=False)
class Hits:
    """What rays hit first.

    Attributes:
        triangle: (n,) int32, counted through all objects in order; -1 for nothing.
        u, v: (n,) float32, barycentric weights of the triangle's second and third corner.
    """

    triangle: np.ndarray
    u: np.ndarray
    v: np.ndarray


class Rays:
    """All triangles of a scene as one Embree mesh, centred so that float32 holds them."""

    def __init__(self, objects: list[Tessellation], middle: np.ndarray) -> None:
        corners = [(t.vertices - middle)[t.faces] for t in objects]
        self._scene = EmbreeScene()
        self._mesh = TriangleMesh(self._scene, np.concatenate(corners).astype(np.float32))

    def first(self, origins: np.ndarray, directions: np.ndarray) -> Hits:
        """What rays (n, 3) float32, (n, 3) float32 hit."""
        found = self._scene.run(origins, directions, output=True)
        return Hits(found["primID"], found["u"], found["v"])
