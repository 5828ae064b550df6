"""Triangles fine enough that what is baked at their corners can be interpolated between them."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from renderer.geometry import in_drawing_order
from scenes.mesh import Mesh, world_mesh
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
    """

    vertices: np.ndarray
    normals: np.ndarray
    faces: np.ndarray


def tessellate(case: Case) -> list[Tessellation]:
    """The objects of a case, edges halved where they are long or near another object.

    Edges are halved by what both of their triangles agree on, so that no cracks open.
    """
    made = [_refined(world_mesh(o), np.empty((0, 3))) for o in case.objects]
    for k, of_one in enumerate(made):
        others = [t.vertices for j, t in enumerate(made) if j != k]
        if others:
            made[k] = _refined(of_one, np.concatenate(others))
    return [_ordered(t) for t in made]


def _refined(mesh: Mesh | Tessellation, others: np.ndarray) -> Tessellation:
    vertices, normals = mesh.vertices.astype(float), mesh.normals.astype(float)
    faces = mesh.faces.astype(np.int64)
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
        vertices, normals, faces = _halved(vertices, normals, faces, edges, of_face, split)
    return Tessellation(vertices, np.float32(normals), faces)


def _ordered(made: Tessellation) -> Tessellation:
    faces, used = in_drawing_order(made.vertices, made.faces)
    return Tessellation(made.vertices[used], made.normals[used], faces)


def _edges(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges (e, 2), each once, and those of each face, (m, 3): from 0 to 1, 1 to 2, 2 to 0."""
    pairs = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    base = faces.max() + 1
    keys, of_face = np.unique(pairs[:, 0] * base + pairs[:, 1], return_inverse=True)
    return np.stack([keys // base, keys % base], axis=1), of_face.reshape(-1, 3)


def _halved(
    vertices: np.ndarray,
    normals: np.ndarray,
    faces: np.ndarray,
    edges: np.ndarray,
    of_face: np.ndarray,
    split: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices, normals and faces with a new vertex in the middle of each edge that is split."""
    middle = np.full(len(edges), -1)
    middle[split] = len(vertices) + np.arange(split.sum())
    vertices = np.concatenate([vertices, vertices[edges[split]].mean(axis=1)])
    normals = np.concatenate([normals, normals[edges[split]].mean(axis=1)])
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
    return vertices, normals, np.concatenate(made)
