"""Triangle meshes, loaded, checked and given one array of normals that both renderers use."""

from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

import numpy as np
import trimesh
from scipy.spatial import cKDTree

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
        carried: what else the vertices have, (n, k) float32 each: `uv` (2), from a picture's lower
            left corner; `albedo` (3), `roughness`, `metallic` and `weight` (1).
    """

    vertices: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    closed: bool
    carried: dict[str, np.ndarray] = field(default_factory=dict)


@cache
def load_mesh(mesh: str) -> Mesh:
    """Load a primitive or a mesh file by absolute path.

    Normals stored in the file are kept; otherwise vertices at one position are merged and get
    the angle-weighted mean of their faces' normals (Thürmer and Wüthrich 1998); where vertices
    carry more than normals they share that mean, but stay apart. Triangles without area are
    dropped. A closed mesh that is inside out is turned.

    Raises:
        InputError: the file is missing, unreadable, empty, or holds NaN, Inf or huge numbers.
    """
    if mesh in PRIMITIVES:
        return _MADE[mesh]()
    path = Path(mesh)
    if not path.is_file():
        raise InputError(path, "mesh", "no such file", "name an existing mesh file")
    if path.suffix.lower() not in FORMATS:
        raise InputError(path, "mesh", "unknown format", f"use one of {', '.join(FORMATS)}")
    try:
        vertices, faces, stored, carried = read_mesh(path)
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
    raw.vertex_attributes["place"] = np.arange(len(vertices))
    if stored is None and carried:
        raw.vertex_normals = _shared_normals(raw)
    elif stored is None:
        raw.merge_vertices()
    raw.update_faces(raw.area_faces > trimesh.tol.zero)
    raw.remove_unreferenced_vertices()
    if len(raw.faces) == 0:
        raise InputError(path, "faces", "all have zero area", "give a mesh with a surface")
    made = _mesh(raw, raw.vertex_normals)
    kept = raw.vertex_attributes["place"]
    carried = {name: np.float32(values[kept]) for name, values in carried.items()}
    for name, values in carried.items():
        if bad := int((~np.isfinite(values)).any(axis=1).sum()):
            raise InputError(path, name, f"{bad} vertices have NaN or Inf", "export it again")
    return replace(made, vertices=np.float32(raw.vertices * size + middle), carried=carried)


def _shared_normals(raw: trimesh.Trimesh) -> np.ndarray:
    """Normals (n, 3) as if vertices at one position were one, though they are not merged."""
    merged = raw.copy()
    merged.merge_vertices()
    merged.update_faces(merged.area_faces > trimesh.tol.zero)
    nearest = cKDTree(merged.vertices).query(raw.vertices)[1]
    return merged.vertex_normals[nearest]


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
    faces, (u, v, _) = [[0, 1, 2], [0, 2, 3]], corners.T + 0.5
    return _carrying(corners, np.tile([0.0, 0, 1], (4, 1)), faces, u, v)


def _globe() -> Mesh:
    """A sphere of radius 1 with u along the azimuth from +x towards +y, and v from -z to +z."""
    columns, rows = 512, 256
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    around, polar = 2 * np.pi * u, np.pi * (1 - v)
    points = np.stack(
        [np.cos(around) * np.sin(polar), np.sin(around) * np.sin(polar), np.cos(polar)], axis=2
    )
    points[:, -1] = points[:, 0]  # the seam is closed to the last bit
    points[[0, -1], :, :2] = 0
    faces = _grid_faces(rows, columns)
    cells = faces.reshape(rows, columns, 2, 3)
    # At a pole one triangle of two is left, and has a corner of its own, in the middle of its base.
    u[0, :-1] = u[-1, 1:] = (u[1, :-1] + u[1, 1:]) / 2
    kept = np.concatenate([cells[1:, :, 0].reshape(-1, 3), cells[:-1, :, 1].reshape(-1, 3)])
    return _carrying(points.reshape(-1, 3), points.reshape(-1, 3), kept, u, v)


def _cylinder() -> Mesh:
    """Radius 1, from z = -1 to 1, closed.

    On its side u runs along the azimuth from +x towards +y and v upwards; its ends show the circle
    within the picture, with u along x.
    """
    columns = 512
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), [0.0, 1.0])
    around = 2 * np.pi * u
    flat = np.stack([np.cos(around), np.sin(around), 0 * around], axis=2)
    flat[:, -1] = flat[:, 0]
    side = flat + (2 * v[..., None] - 1) * [0, 0, 1]
    points, normals = [side.reshape(-1, 3)], [flat.reshape(-1, 3)]
    uvs, faces = [np.stack([u, v], axis=2).reshape(-1, 2)], [_grid_faces(1, columns)]
    rim = np.arange(columns)
    for z in (-1.0, 1.0):
        first = sum(map(len, points))
        cap = np.vstack([flat[0, :-1] + [0, 0, z], [[0, 0, z]]])
        ring = np.stack([rim, (rim + 1) % columns, np.full(columns, columns)], axis=1)
        points.append(cap)
        normals.append(np.tile([0.0, 0, z], (columns + 1, 1)))
        uvs.append(cap[:, :2] / 2 + 0.5)
        faces.append(first + (ring if z > 0 else ring[:, ::-1]))
    u, v = np.vstack(uvs).T
    return _carrying(np.vstack(points), np.vstack(normals), np.vstack(faces), u, v)


def _grid_faces(rows: int, columns: int) -> np.ndarray:
    """Two triangles for each cell of a grid of vertices, row by row, (2 rows columns, 3)."""
    corner = np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)
    a, b, c, d = corner, corner + 1, corner + columns + 2, corner + columns + 1
    return np.stack([np.stack([a, b, c], 2), np.stack([a, c, d], 2)], axis=2).reshape(-1, 3)


def _carrying(
    points: np.ndarray, normals: np.ndarray, faces: np.ndarray, u: np.ndarray, v: np.ndarray
) -> Mesh:
    """A mesh with texture coordinates."""
    raw = trimesh.Trimesh(points, faces, process=False)
    uvs = np.stack([u.ravel(), v.ravel()], axis=1)
    return replace(_mesh(raw, normals), carried={"uv": np.float32(uvs)})


_MADE = {"sphere": _sphere, "plane": _plane, "globe": _globe, "cylinder": _cylinder}


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
    return replace(mesh, vertices=np.float32(vertices), normals=np.float32(normals))
