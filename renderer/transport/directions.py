"""Directions of the sphere as cells of an octahedral map; the twin of shaders/octahedral.glsl.

Meyer et al. 2010, "On Floating-Point Normal Vectors": the sphere's octahedron unfolded to a square.
Row and column of a cell grow with y and x; the upper half (z > 0) is the square's middle.
"""

import numpy as np
from scipy.spatial import cKDTree

AROUND = 13  # cells that hold a cell's neighbours on all sides, and itself


def cells_around(side: int, coarse: int) -> np.ndarray:
    """The cells nearest to each, (side², AROUND), the cell itself among them."""
    directions = cell_directions(side, coarse)
    return cKDTree(directions).query(directions, k=min(AROUND, len(directions)))[1]


def cell_shares(side: int, coarse: int) -> np.ndarray:
    """The shares of the sphere that cells hold, (side²,).

    The octahedron's faces are all equally far: a share falls as the cube of the distance to it.
    """
    shares = np.abs(cell_directions(side, coarse)).sum(axis=1) ** 3
    return shares / shares.sum()


def cell_directions(side: int, coarse: int) -> np.ndarray:
    """Unit directions through the middles of side x side cells, (side², 3).

    The cells of one of coarse x coarse larger ones follow one another; both go row by row.
    """
    at = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(at, at)
    z = 1 - np.abs(x) - np.abs(y)
    fold = np.maximum(-z, 0)
    d = np.stack([x - np.copysign(fold, x), y - np.copysign(fold, y), z], axis=2)
    d = d / np.linalg.norm(d, axis=2, keepdims=True)
    per = side // coarse
    return d.reshape(coarse, per, coarse, per, 3).swapaxes(1, 2).reshape(-1, 3)
