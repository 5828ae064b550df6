"""Triangles fine enough that what is baked at their corners can be interpolated between them."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from renderer.geometry import in_drawing_order
from renderer.transport.carried import carried
from scenes.mesh import world_mesh
from scenes.schema import Case

FINEST, COARSEST = 1 / 512, 1 / 24  # edges, as shares of an object's extent
NEAR = 0.25  # an edge may be as long as this share of its distance to another object
MOST_VERTICES = 200_000  # of an object; one that has more is left as it is


@dataclass(frozen=True, eq=False)
class Tessellation:
    """An object's triangles in world space, the same surface as its mesh.

    Attributes:
        vertices: (n, 3) float64, world units.
        normals: (n, 3) float32; those of new vertices are means, and shorter than 1, so that
            interpolation gives what it gave.
        faces: (m, 3) uint32.
        carried: (n, k) float32, as `renderer.transport.carried` has it; those of new vertices are
            means.
    """

    vertices: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    carried: np.ndarray


def tessellate(case: Case) -> list[Tessellation]:
    """The objects of a case, edges halved where they are long or near another object.

    Edges are halved by what both of their triangles agree on, so that no cracks open.
    """
    made = [_refined(t, np.empty((0, 3))) for t in _meshes(case)]
    for k, of_one in enumerate(made):
        others = [t.vertices for j, t in enumerate(made) if j != k]
        if others:
            made[k] = _refined(of_one, np.concatenate(others))
    return [_ordered(t) for t in made]


def untouched(case: Case) -> list[Tessellation]:
    """The objects of a case with the triangles that they have."""
    return [_ordered(t) for t in _meshes(case)]


def _meshes(case: Case) -> list[Tessellation]:
    meshes = [world_mesh(o) for o in case.objects]
    return [
        Tessellation(m.vertices, m.normals, m.faces, carried(o, len(m.vertices)))
        for o, m in zip(case.objects, meshes, strict=True)
    ]


def _refined(mesh: Tessellation, others: np.ndarray) -> Tessellation:
    # All that is interpolated, in one array.
    rows = [mesh.vertices, mesh.normals, mesh.carried]
    values = np.hstack([r.astype(float) for r in rows])
    vertices, faces = values[:, :3], mesh.faces.astype(np.int64)
    extent = np.ptp(vertices, axis=0).max()
    near = cKDTree(others) if len(others) else None
    while True:
        edges, of_face = _edges(faces)
        ends = vertices[edges]
        length = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
        allowed = np.full(len(edges), COARSEST * extent)
        if near is not None:
            # Further than the longest edge cares for is all the same, and infinite.
            reach = length.max() * (1 / NEAR + 0.5)
            distance = near.query(ends.mean(axis=1), distance_upper_bound=reach)[0] - length / 2
            allowed = np.clip(NEAR * distance, FINEST * extent, allowed)
        split = length > allowed
        if not split.any() or len(vertices) + split.sum() > MOST_VERTICES:
            break
        values, faces = _halved(values, faces, edges, of_face, split)
        vertices = values[:, :3]
    return Tessellation(vertices, np.float32(values[:, 3:6]), faces, np.float32(values[:, 6:]))


def _ordered(made: Tessellation) -> Tessellation:
    faces, used = in_drawing_order(made.vertices, made.faces)
    return Tessellation(made.vertices[used], made.normals[used], faces, made.carried[used])


def _edges(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges (e, 2), each once, and those of each face, (m, 3): from 0 to 1, 1 to 2, 2 to 0."""
    pairs = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    base = faces.max() + 1
    keys, of_face = np.unique(pairs[:, 0] * base + pairs[:, 1], return_inverse=True)
    return np.stack([keys // base, keys % base], axis=1), of_face.reshape(-1, 3)


def _halved(
    values: np.ndarray,
    faces: np.ndarray,
    edges: np.ndarray,
    of_face: np.ndarray,
    split: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Vertices' values and faces with a new vertex in the middle of each edge that is split."""
    middle = np.full(len(edges), -1)
    middle[split] = len(values) + np.arange(split.sum())
    values = np.concatenate([values, values[edges[split]].mean(axis=1)])
    m = middle[of_face]  # (faces, 3), -1 where the edge stays
    count = (m >= 0).sum(axis=1)
    made = [faces[count == 0]]
    # Turned so that a lone split edge is the first, or a lone whole edge the last.
    lone = np.where(count == 1, np.argmax(m >= 0, axis=1), (np.argmax(m < 0, axis=1) + 1) % 3)
    turn = (np.arange(3) + lone[:, None]) % 3
    a, b, c = np.take_along_axis(faces, turn, axis=1).T
    ab, bc, ca = np.take_along_axis(m, turn, axis=1).T
    for number, triangles in (
        (1, ((a, ab, c), (ab, b, c))),
        (2, ((a, ab, c), (ab, bc, c), (ab, b, bc))),
        (3, ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))),
    ):
        of = count == number
        made += [np.stack([corner[of] for corner in t], axis=1) for t in triangles]
    return values, np.concatenate(made)
