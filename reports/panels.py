"""Gauss-Legendre quadrature over panels, whose ends are where an integrand has a kink."""

from functools import cache

import numpy as np


def panels(ends: np.ndarray, nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights (..., panels x nodes) for panels between ends (..., panels + 1)."""
    x, w = _gauss(nodes)
    start, width = ends[..., :-1, None], np.diff(ends)[..., None]
    shape = (*ends.shape[:-1], -1)
    return (start + width * x).reshape(shape), (width * w).reshape(shape)


@cache
def _gauss(nodes: int) -> tuple[np.ndarray, np.ndarray]:
    x, w = np.polynomial.legendre.leggauss(nodes)
    return (x + 1) / 2, w / 2
