"""Smooth noise in space, at several scales: it has no seam and no pole on a sphere."""

import numpy as np
from scipy.ndimage import map_coordinates

from scenes.draw.dice import Rng

CELLS = 32  # of the lattice, which repeats
# Of quadratic B-splines over values drawn evenly from [-1, 1]: 1/3, times the mean over a cell of
# the sum of squared weights, 11/20, along each axis.
DEVIATION = (1 / 3 * (11 / 20) ** 3) ** 0.5


def noise(
    rng: Rng, points: np.ndarray, scale: float, octaves: int, gain: float = 0.5
) -> np.ndarray:
    """Noise of mean 0 and deviation 1 at points (..., 3); returns (...).

    Args:
        scale: features of the coarsest octave in a unit of length; each further one has twice
            as many, and `gain` times the height.
    """
    total, power = np.zeros(points.shape[:-1]), 0.0
    for octave in range(octaves):
        lattice = rng.uniform(-1, 1, (CELLS,) * 3)
        places = np.moveaxis(points, -1, 0) * scale * 2**octave + rng.uniform(0, CELLS, 3).reshape(
            3, *(1,) * (points.ndim - 1)
        )
        height = gain**octave
        total += height * map_coordinates(
            lattice, places, order=2, mode="grid-wrap", prefilter=False
        )
        power += height**2
    return total / (DEVIATION * power**0.5)
