"""The direction along a surface in which it is brushed, and in which normal maps count u."""

from functools import cache

import numpy as np

from scenes.mesh import load_mesh, placement, world_mesh
from scenes.schema import Object


def world_tangents(obj: Object) -> np.ndarray:
    """Tangents at the vertices of `world_mesh(obj)`, (n, 4) float32: unit x, y, z, and a sign.

    x, y, z is perpendicular to the normal n, and sign cross(n, tangent) is the bitangent. Renderers
    interpolate x, y, z between vertices, then make it perpendicular to the interpolated normal.
    """
    local, matrix = _tangents(obj.mesh), placement(obj)[:3, :3]
    normals = world_mesh(obj).normals.astype(float)
    along = local[:, :3] @ matrix.T
    tangents = _perpendicular(along, normals)
    return np.float32(np.hstack([tangents, local[:, 3:]]))


@cache
def _tangents(mesh: str) -> np.ndarray:
    """Tangents in the mesh's own space, (n, 4) float64.

    At a vertex they are the mean of the directions in which u grows on the triangles around it,
    by the triangles' angles there, as in Mikkelsen 2008 (vertices that triangles of both signs
    share are not split: the sign of the most counts). Where there are no texture coordinates, or
    triangles have none of their area in them, the tangent runs around the z axis,
    counter-clockwise seen from +z; on the axis itself along x.
    """
    made = load_mesh(mesh)
    normals = made.normals.astype(float)
    along, across = _gradients(mesh) if "uv" in made.carried else (np.zeros_like(normals),) * 2
    along = along - normals * (along * normals).sum(axis=1, keepdims=True)
    flat = np.linalg.norm(along, axis=1) < 1e-6
    along[flat] = np.cross([0.0, 0.0, 1.0], normals[flat])
    tangents = _perpendicular(along, normals)
    sign = np.where((np.cross(normals, tangents) * across).sum(axis=1) < 0, -1.0, 1.0)
    return np.hstack([tangents, sign[:, None]])


def _gradients(mesh: str) -> tuple[np.ndarray, np.ndarray]:
    """Unit directions of growing u and v, summed at each vertex by angle, (n, 3) each."""
    made = load_mesh(mesh)
    corners = made.vertices.astype(float)[made.faces]
    e1, e2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    uv = made.carried["uv"].astype(float)[made.faces]
    d1, d2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    area = d1[:, 0] * d2[:, 1] - d2[:, 0] * d1[:, 1]
    known = np.abs(area) > 1e-12 * (np.abs(d1).max(axis=1) * np.abs(d2).max(axis=1))
    turned = np.where(known, np.sign(area), 0)[:, None]
    du = _unit(turned * (e1 * d2[:, 1:] - e2 * d1[:, 1:]))
    dv = _unit(turned * (e2 * d1[:, :1] - e1 * d2[:, :1]))
    along, across = np.zeros((2, len(made.vertices), 3))
    for k in range(3):
        to, other = (corners[:, (k + j) % 3] - corners[:, k] for j in (1, 2))
        cosine = (_unit(to) * _unit(other)).sum(axis=1)
        angle = np.arccos(np.clip(cosine, -1, 1))[:, None]
        np.add.at(along, made.faces[:, k], angle * du)
        np.add.at(across, made.faces[:, k], angle * dv)
    return along, across


def _perpendicular(along: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Unit vectors perpendicular to unit normals, nearest to `along`; along x or y if it is 0."""
    across = along - normals * (along * normals).sum(axis=1, keepdims=True)
    none = np.linalg.norm(across, axis=1) < 1e-6 * np.maximum(np.linalg.norm(along, axis=1), 1e-30)
    axis = np.where(np.abs(normals[:, :1]) < 0.9, [1.0, 0, 0], [0, 1.0, 0])
    spare = axis - normals * (axis * normals).sum(axis=1, keepdims=True)
    return _unit(np.where(none[:, None], spare, across))


def _unit(v: np.ndarray) -> np.ndarray:
    return v / np.maximum(np.linalg.norm(v, axis=1, keepdims=True), 1e-300)
