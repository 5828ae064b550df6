"""Meshes on the GPU: one vertex buffer per mesh, ordered for locality, shared by instances."""

from functools import cache

import moderngl
import numpy as np

from renderer.context import context
from scenes.mesh import load_mesh


@cache
def buffers(mesh: str) -> tuple[moderngl.Buffer, moderngl.Buffer]:
    """Vertices (position, normal: 6 float32) and indices (uint32).

    Triangles follow a Morton curve and vertices their first use: on a software rasteriser this
    makes the vertex stage about twice as fast, and the picture is the same. Positions are relative
    to `middle`: far from the mesh's own origin float32 would lose them in the sums to come.
    """
    loaded = load_mesh(mesh)
    faces, order = in_drawing_order(loaded.vertices, loaded.faces)
    vertices = np.hstack([loaded.vertices - middle(mesh), loaded.normals])[order]
    gl = context()
    return gl.buffer(np.float32(vertices).tobytes()), gl.buffer(faces.tobytes())


def in_drawing_order(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Faces (m, 3) uint32 along a Morton curve, and the vertices in the order of their first use.

    The faces name places in that order.
    """
    faces = faces[np.argsort(_morton(vertices[faces].mean(axis=1)))]
    used, first = np.unique(faces, return_index=True)
    order = used[np.argsort(first)]
    rank = np.empty(len(vertices), np.uint32)
    rank[order] = np.arange(len(order), dtype=np.uint32)
    return rank[faces], order


@cache
def middle(mesh: str) -> np.ndarray:
    """The middle of a mesh's bounding box, (3,) float64."""
    points = load_mesh(mesh).vertices
    return (points.min(axis=0).astype(float) + points.max(axis=0)) / 2


def _morton(points: np.ndarray) -> np.ndarray:
    """30-bit Morton codes of points (n, 3) over their own bounding box."""
    low, high = points.min(axis=0), points.max(axis=0)
    cells = ((points - low) / np.maximum(high - low, 1e-30) * 1023).astype(np.uint32)
    for shift, keep in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        cells = (cells | (cells << shift)) & keep
    return cells[:, 0] | (cells[:, 1] << 1) | (cells[:, 2] << 2)
