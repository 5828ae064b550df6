"""Triangle meshes, loaded, checked and given one array of normals that both renderers use."""

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import trimesh

from scenes.errors import InputError
from scenes.mesh_file import DamagedError, read_mesh
from scenes.schema import PRIMITIVES, Object

FORMATS = (".ply", ".obj", ".stl", ".glb")
FURTHEST = 1e15  # squares of coordinates, as in areas, stay inside float32


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles with a unit normal per vertex.

    Attributes:
        vertices: (n, 3) float32, in the mesh's own units.
        normals: (n, 3) float32, unit length.
        faces: (m, 3) uint32, counter-clockwise seen from outside.
        closed: watertight and consistently wound, so that back faces are never seen.
    """

    vertices: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    closed: bool


@cache
def load_mesh(mesh: str) -> Mesh:
    """Load a primitive ("sphere", "plane") or a mesh file by absolute path.

    Normals stored in the file are kept; otherwise vertices at one position are merged and get
    the angle-weighted mean of their faces' normals (Thürmer and Wüthrich 1998). Triangles without
    area are dropped. A closed mesh that is inside out is turned.

    Raises:
        InputError: the file is missing, unreadable, empty, or holds NaN, Inf or huge numbers.
    """
    if mesh in PRIMITIVES:
        return _sphere() if mesh == "sphere" else _plane()
    path = Path(mesh)
    if not path.is_file():
        raise InputError(path, "mesh", "no such file", "name an existing mesh file")
    if path.suffix.lower() not in FORMATS:
        raise InputError(path, "mesh", "unknown format", f"use one of {', '.join(FORMATS)}")
    try:
        vertices, faces, stored = read_mesh(path)
    except DamagedError as error:
        raise InputError(path, "mesh", str(error), "export it again, as one file") from error
    except OSError as error:
        problem = f"cannot be read ({error.strerror})"
        raise InputError(path, "mesh", problem, "check its permissions") from error
    if len(faces) == 0 or len(vertices) == 0:
        raise InputError(path, "mesh", "has no triangles", "give a mesh with at least one triangle")
    if bad := int((~(np.abs(vertices) <= FURTHEST)).any(axis=1).sum()):
        problem = f"{bad} are NaN, Inf or beyond {FURTHEST:g}"
        raise InputError(path, "vertices", problem, "export it again")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise InputError(path, "faces", "name vertices that do not exist", "export it again")
    if stored is not None and not np.isfinite(stored).all():
        stored = None
    # trimesh's tolerances are lengths: they fit a mesh of size 1 at the origin.
    used = vertices[np.unique(faces)]  # a stray vertex says nothing of its size
    middle = (used.min(axis=0) + used.max(axis=0)) / 2
    size = np.ptp(used, axis=0).max() or 1.0
    raw = trimesh.Trimesh((vertices - middle) / size, faces, vertex_normals=stored, process=False)
    if stored is None:
        raw.merge_vertices()
    raw.update_faces(raw.area_faces > trimesh.tol.zero)
    raw.remove_unreferenced_vertices()
    if len(raw.faces) == 0:
        raise InputError(path, "faces", "all have zero area", "give a mesh with a surface")
    made = _mesh(raw, raw.vertex_normals)
    return replace(made, vertices=np.float32(raw.vertices * size + middle))


def _mesh(raw: trimesh.Trimesh, normals: np.ndarray) -> Mesh:
    """Freeze a trimesh; a normal of no length becomes the direction of its first face."""
    normals = np.array(normals, float)
    lengths = np.linalg.norm(normals, axis=1)
    if (flat := ~(lengths > 1e-12)).any():
        first = np.zeros(len(normals), int)
        first[raw.faces[::-1].ravel()] = np.repeat(np.arange(len(raw.faces))[::-1], 3)
        normals[flat] = raw.face_normals[first[flat]]
        lengths[flat] = 1
    normals /= lengths[:, None]
    faces, welded = np.asarray(raw.faces), raw.copy()
    welded.merge_vertices(merge_norm=True, merge_tex=True)
    closed = bool(welded.is_watertight and welded.is_winding_consistent)
    a, b, c = welded.triangles.transpose(1, 0, 2)
    if closed and (a * np.cross(b, c)).sum() < 0:  # six times the signed volume
        faces = faces[:, ::-1]
        if (normals[faces].sum(axis=1) * -raw.face_normals).sum() < 0:
            normals = -normals
    return Mesh(
        np.ascontiguousarray(raw.vertices, np.float32),
        np.ascontiguousarray(normals, np.float32),
        np.ascontiguousarray(faces, np.uint32),
        closed,
    )


def _sphere() -> Mesh:
    """A sphere of radius 1 with exact normals, fine enough that facets are under a pixel."""
    raw = trimesh.creation.icosphere(subdivisions=6)
    return _mesh(raw, raw.vertices)


def _plane() -> Mesh:
    """A square of side 1 in z = 0 that faces up."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) / 2
    raw = trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], process=False)
    return _mesh(raw, np.tile([0.0, 0, 1], (4, 1)))


def placement(obj: Object) -> np.ndarray:
    """The (4, 4) float64 matrix that takes the object's mesh to world space.

    Raises:
        InputError: a height is asked of a flat mesh, or the object ends up further than FURTHEST
            from the origin, or smaller or thinner by as much than float32 can square.
    """
    matrix = trimesh.transformations.euler_matrix(*np.radians(obj.rotate), axes="sxyz")
    scale = np.broadcast_to(np.asarray(obj.scale, float), 3)
    position = np.asarray(obj.position, float)
    low, high = _extent(obj.mesh, tuple(obj.rotate), tuple(scale.tolist()))
    if obj.height is None:
        matrix[:3, :3] *= scale
        matrix[:3, 3] = position
        _within_reach(obj, scale, low + position, high + position)
        return matrix
    if high[2] - low[2] <= 0:
        raise InputError(obj.mesh, "height", "the mesh is flat", "set 'scale' instead of 'height'")
    factor = obj.height / (high[2] - low[2])
    base = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    matrix[:3, :3] *= scale * factor
    matrix[:3, 3] = position - factor * base
    ends = (matrix[:3, 3] + factor * end for end in (low, high))
    _within_reach(obj, scale * factor, *ends)
    return matrix


def _within_reach(obj: Object, scales: np.ndarray, low: np.ndarray, high: np.ndarray) -> None:
    """Refuse an object whose squares of coordinates or areas would leave float32."""
    fits = (
        np.abs([low, high]).max() <= FURTHEST
        and (high - low).max() >= 1 / FURTHEST
        and scales.max() <= FURTHEST * scales.min()
    )
    if not fits:
        size = " x ".join(f"{s:.3g}" for s in high - low)
        problem = f"the object '{obj.name}' is {size} in size, {np.abs([low, high]).max():.3g} far"
        remedy = (
            f"keep sizes above {1 / FURTHEST:g}, and coordinates and stretch within {FURTHEST:g}"
        )
        raise InputError(obj.mesh, "scale", problem, remedy)


@cache  # asked for many times a picture, and it reads every vertex
def _extent(
    mesh: str, rotate: tuple[float, ...], scale: tuple[float, ...]
) -> tuple[np.ndarray, np.ndarray]:
    """The least and the greatest coordinates of a scaled and turned mesh, (3,) each."""
    matrix = trimesh.transformations.euler_matrix(*np.radians(rotate), axes="sxyz")
    turned = load_mesh(mesh).vertices.astype(float) @ (matrix[:3, :3] * scale).T
    return turned.min(axis=0), turned.max(axis=0)


def world_mesh(obj: Object) -> Mesh:
    """The object's mesh with vertices and unit normals in world space."""
    mesh, matrix = load_mesh(obj.mesh), placement(obj)
    vertices = mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    normals = mesh.normals @ np.linalg.inv(matrix[:3, :3])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Mesh(vertices.astype(np.float32), normals.astype(np.float32), mesh.faces, mesh.closed)
