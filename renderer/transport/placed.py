"""A scene's triangles on the GPU, so that a pixel can be told which one it shows."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import moderngl
import numpy as np

from renderer.context import context
from renderer.objects import placed_in_world
from renderer.program import Maps, program
from renderer.transport import stored
from renderer.transport.carried import COLUMNS, WIDTH
from renderer.transport.rows import holding
from renderer.transport.tessellation import Tessellation, untouched
from renderer.view import View
from scenes.schema import Case


@dataclass(frozen=True, eq=False)
class Placed:
    """Objects in world space, their triangles counted through the scene.

    Attributes:
        maps: by their names in GLSL.
        middle: (3,) float64, world; positions are from there.
        buffers: vertices (position, normal: 6 float32) and indices (uint32) of each object.
        first_triangle: of each object.
        triangles: (m, 3, 3) float32, corners of all of them from the middle.
        vertices: how many there are.
    """

    maps: Maps
    middle: np.ndarray
    buffers: list[tuple[moderngl.Buffer, moderngl.Buffer]]
    first_triangle: list[int]
    triangles: np.ndarray
    vertices: int

    def drawn(
        self, index: int, camera: View
    ) -> tuple[moderngl.Program, moderngl.VertexArray, dict[str, Any]]:
        """The program that rasterises an object, its triangles, and where they are."""
        raster = program("placed.vert", "surface.frag", frozenset({"PLACED"}))
        vertices, indices = self.buffers[index]
        layout = (vertices, "3f 3f", "position", "normal")
        array = context().vertex_array(raster, [layout], indices)
        where = placed_in_world(self.middle, camera)
        return raster, array, where | {"first_triangle": self.first_triangle[index]}


def placed_meshes(case: Case) -> Placed:
    """The case's meshes as they are.

    Raises:
        InputError: a mesh lacks what a material's maps need.
    """
    return _placed(stored.placement(case))


@lru_cache(maxsize=4)
def _placed(placement: stored.Placement) -> Placed:
    return place(untouched(placement.case))


def place(objects: list[Tessellation]) -> Placed:
    """Objects' triangles and what their vertices carry."""
    vertices = np.concatenate([t.vertices.astype(float) for t in objects])
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    first_vertex = np.cumsum([0, *(len(t.vertices) for t in objects)]).tolist()
    first_triangle = np.cumsum([0, *(len(t.faces) for t in objects)]).tolist()
    corners = np.concatenate([t.faces + n for t, n in zip(objects, first_vertex, strict=False)])
    vertex_of = np.repeat(np.arange(len(objects)), [len(t.vertices) for t in objects])
    triangle_of = np.repeat(np.arange(len(objects)), [len(t.faces) for t in objects])
    normals = np.concatenate([t.normals for t in objects])
    points = np.float32(vertices - middle)
    gl = context()
    return Placed(
        maps={
            "corners": holding(four(corners.astype(np.uint32), triangle_of), "u4"),
            "positions": holding(four(points, _curvature(points, normals, corners)), "f4"),
            "normals": holding(four(normals, vertex_of), "f4"),
            **_carried(objects),
        },
        middle=middle,
        buffers=[
            (
                gl.buffer(np.float32(np.hstack([t.vertices - middle, t.normals])).tobytes()),
                gl.buffer(t.faces.astype(np.uint32).tobytes()),
            )
            for t in objects
        ],
        first_triangle=first_triangle,
        triangles=points[corners],
        vertices=len(vertices),
    )


def _curvature(points: np.ndarray, normals: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """How fast the normal turns around each vertex, (n,) float32 radians per length: root mean
    square over the edges that meet there."""
    ends = corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    turn, run = (((v[ends[:, 0]] - v[ends[:, 1]]) ** 2).sum(axis=1) for v in (normals, points))
    sums = [
        sum(np.bincount(ends[:, k], of, minlength=len(points)) for k in (0, 1))
        for of in (turn, run)
    ]
    return np.float32(np.sqrt(sums[0] / np.maximum(sums[1], 1e-30)))


def _carried(objects: list[Tessellation]) -> Maps:
    """Textures of what vertices carry, if any object's do."""
    if not any(t.carried.size for t in objects):
        return {}
    columns = [t.carried if t.carried.size else np.ones((len(t.vertices), WIDTH)) for t in objects]
    together = np.float32(np.concatenate(columns))
    parts = {name: together[:, first : first + n] for name, (first, n) in COLUMNS.items()}
    return {name: holding(four(p) if p.shape[1] == 3 else p, "f4") for name, p in parts.items()}


def four(values: np.ndarray, last: np.ndarray | int = 0) -> np.ndarray:
    """Rows (n, 3) with a fourth column."""
    fourth = np.broadcast_to(np.asarray(last, values.dtype), len(values))
    return np.hstack([values, fourth[:, None]])
