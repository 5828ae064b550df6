"""A scene's baked geometry on the GPU."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import moderngl
import numpy as np

from renderer.context import context
from renderer.objects import placed_in_world
from renderer.program import Maps, program
from renderer.transport import stored
from renderer.transport.bvh import build
from renderer.transport.tessellation import Tessellation, tessellate
from renderer.transport.visibility import NOBODY, VERTEX, Visibility, bake
from renderer.view import View
from scenes.schema import Case

ROW = 4096  # as in shaders/rows.glsl


@dataclass(frozen=True, eq=False)
class SceneGeometry:
    """What depends on a scene's geometry alone.

    Attributes:
        maps: by their names in GLSL.
        middle: (3,) float64, world; positions are from there.
        buffers: vertices (position, normal: 6 float32) and indices (uint32) of each object.
        first_triangle: of each object, counted through the scene.
        vertices, sights: how many there are.
        size: of the scene's bounding box, its longest side.
    """

    maps: Maps
    middle: np.ndarray
    buffers: list[tuple[moderngl.Buffer, moderngl.Buffer]]
    first_triangle: list[int]
    vertices: int
    sights: int
    size: float

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


def scene_geometry(case: Case) -> SceneGeometry:
    """The baked geometry of a case, from disk where it has been made before."""
    return _loaded(stored.key(case), case.model_copy(update={"id": ""}))


@lru_cache(maxsize=4)
def _loaded(_key: str, case: Case) -> SceneGeometry:
    objects, visibility = stored.baked(_key, lambda: _made(case))
    vertices = np.concatenate([t.vertices for t in objects])
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    normals = np.concatenate([t.normals for t in objects])
    first_vertex = np.cumsum([0, *(len(t.vertices) for t in objects)]).tolist()
    first_triangle = np.cumsum([0, *(len(t.faces) for t in objects)]).tolist()
    corners = np.concatenate([t.faces + n for t, n in zip(objects, first_vertex, strict=False)])
    vertex_of = np.repeat(np.arange(len(objects)), [len(t.vertices) for t in objects])
    triangle_of = np.repeat(np.arange(len(objects)), [len(t.faces) for t in objects])
    points = np.float32(vertices - middle)
    sights, index = _sights(visibility)
    gl = context()
    return SceneGeometry(
        maps={
            "open_bits": _rows(visibility.open.reshape(-1, 1), "u4"),
            "clear_bits": _rows(visibility.clear.reshape(-1, 1), "u4"),
            "flux": _rows(visibility.flux.reshape(-1, 2), "f1"),
            "sights": _rows(sights, "u4"),
            "sight_index": _rows(index, "u4"),
            "corners": _rows(_four(corners.astype(np.uint32), triangle_of), "u4"),
            "positions": _rows(_four(points), "f4"),
            "normals": _rows(_four(normals, vertex_of), "f4"),
            **_tree(points[corners]),
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
        vertices=len(vertices),
        sights=len(sights),
        size=float(np.ptp(points, axis=0).max()),
    )


def _tree(triangles: np.ndarray) -> Maps:
    """The textures of a hierarchy over triangles (n, 3, 3)."""
    tree = build(triangles)
    at = np.where(tree.order[:, None, None] >= 0, triangles[tree.order], 0)
    rows = np.stack([at[:, 0], at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]], axis=1)
    numbers = np.repeat(tree.order, 3).astype(np.float32)
    return {
        "bvh_nodes": _rows(tree.nodes.reshape(-1, 4), "f4"),
        "bvh_triangles": _rows(_four(rows.reshape(-1, 3), numbers), "f4"),
    }


def _sights(visibility: Visibility) -> tuple[np.ndarray, np.ndarray]:
    """Sights (m, WITNESSES) uint32, and where to find them, (vertices SEEN², 1) uint32.

    Those that see the same stand together: shaded in a row, they read the same.
    """
    order = np.argsort(visibility.sights.min(axis=1) & VERTEX, kind="stable")
    index = np.full((visibility.seeing.size, 1), NOBODY)
    there = np.flatnonzero(visibility.seeing)
    index[there[order], 0] = np.arange(len(there), dtype=np.uint32)
    return visibility.sights[order], index


def _made(case: Case) -> tuple[list[Tessellation], Visibility]:
    objects = tessellate(case)
    return objects, bake(objects)


def _four(rows: np.ndarray, last: np.ndarray | int = 0) -> np.ndarray:
    """Rows (n, 3) with a fourth column."""
    fourth = np.broadcast_to(np.asarray(last, rows.dtype), len(rows))
    return np.hstack([rows, fourth[:, None]])


def _rows(values: np.ndarray, dtype: str) -> moderngl.Texture:
    """A texture ROW wide that holds values (n, components) one after the other."""
    height = max(-(-len(values) // ROW), 1)
    whole = np.zeros((height * ROW, values.shape[1]), values.dtype)
    whole[: len(values)] = values
    texture = context().texture((ROW, height), values.shape[1], whole.tobytes(), dtype=dtype)
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    return texture
