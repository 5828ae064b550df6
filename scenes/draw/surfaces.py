"""Meshes from grids of points: a tube that closes on itself, and a box to be bent."""

import numpy as np
import trimesh


def tube(points: np.ndarray) -> trimesh.Trimesh:
    """A closed surface through points (n, m, 3), both of whose grid's edges join.

    Its outside is on the side of d/dn x d/dm.
    """
    n, m = points.shape[:2]
    here = np.arange(n * m).reshape(n, m)
    along, around = np.roll(here, -1, 0), np.roll(here, -1, 1)
    return _quads(points.reshape(-1, 3), here, along, np.roll(along, -1, 1), around)


def box(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> trimesh.Trimesh:
    """A closed box with corners of its quads at the given ascending coordinates."""
    axes, sides = (x, y, z), []
    for normal in range(3):
        u, v = (normal + 1) % 3, (normal + 2) % 3
        for end in (0, -1):
            grid = np.empty((len(axes[u]), len(axes[v]), 3))
            grid[..., u], grid[..., v] = np.meshgrid(axes[u], axes[v], indexing="ij")
            grid[..., normal] = axes[normal][end]
            here = np.arange(grid[..., 0].size).reshape(grid.shape[:2])
            corners = here[:-1, :-1], here[1:, :-1], here[1:, 1:], here[:-1, 1:]
            sides.append(_quads(grid.reshape(-1, 3), *(corners if end else corners[::-1])))
    whole = trimesh.util.concatenate(sides)
    whole.merge_vertices()
    return whole


def creased(mesh: trimesh.Trimesh, degrees: float = 35) -> trimesh.Trimesh:
    """The mesh with its vertices split where faces meet at more than an angle."""
    return trimesh.graph.smooth_shade(mesh, angle=np.radians(degrees), facet_minarea=None)


def _quads(points: np.ndarray, a, b, c, d) -> trimesh.Trimesh:
    """Two triangles for each quad a, b, c, d of indices."""
    a, b, c, d = (i.ravel() for i in (a, b, c, d))
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return trimesh.Trimesh(points, faces, process=False)
