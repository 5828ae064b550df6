"""Grids of hard inputs: the atlas' axes, and the directions that are tried in each of its cells."""

import numpy as np

from reports.stability.results import Axis

ALPHAS = 10 ** np.linspace(-4, 0, 17)  # four a decade, .01 among them
COSINES = 10 ** np.linspace(-6, 0, 13)
WEIGHTS = np.array([0, 1e-7, 0.25, 0.5, 0.75, 1 - 1e-7, 1])
PER_CELL = 192
JUDGED = {"alpha": (0.01, 1.0), "n.v": (1e-4, 1.0)}  # where the limit of 1e-4 is promised


def axis(name: str, values: np.ndarray | list[float], log: bool = False) -> Axis:
    """An axis of a map."""
    return Axis(name=name, values=[float(v) for v in values], log=log)


ALPHA, COSINE = axis("alpha", ALPHAS, log=True), axis("n.v", COSINES, log=True)
WEIGHT = axis("weight", WEIGHTS)
ONE = axis("", [0.0])  # of a map without slices, or without rows


def spread(rows: np.ndarray, columns: np.ndarray, per_cell: int) -> tuple[np.ndarray, np.ndarray]:
    """The values of two axes at `per_cell` inputs in each cell, both (rows x columns x k,)."""
    shape = (len(rows), len(columns), per_cell)
    down = np.broadcast_to(np.reshape(rows, (-1, 1, 1)), shape)
    across = np.broadcast_to(np.reshape(columns, (1, -1, 1)), shape)
    return down.ravel(), across.ravel()


def unit(cosine: np.ndarray, azimuth: np.ndarray, sine: np.ndarray | None = None) -> np.ndarray:
    """Directions (..., 3) by their cosine to n and azimuth in radians; near n give the sine too."""
    if sine is None:
        sine = np.sqrt(np.maximum(1 - cosine**2, 0))
    parts = [sine * np.cos(azimuth), sine * np.sin(azimuth), cosine + 0 * azimuth]
    return np.stack(parts, axis=-1)


def pairs(
    alphas: np.ndarray = ALPHAS,
    cosines: np.ndarray = COSINES,
    per_cell: int = PER_CELL,
    seed: int = 0,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Directions to try in every cell of n.v x alpha.

    In each cell one wi mirrors wo about n exactly and one is wo itself; of the others half mirror
    wo about facets within 5 alpha of n, where the lobe is, and half lie anywhere, down to n.l of
    1e-6, a quarter of these nearly opposite to wo.

    Returns:
        alpha (n,), wi and wo (n, 3), all float32, n = len(cosines) x len(alphas) x per_cell.
    """
    rng = np.random.default_rng(seed)
    cos_o, alpha = spread(cosines, alphas, per_cell)
    count = alpha.size
    turn_o = rng.uniform(0, 2 * np.pi, count)
    wo = unit(cos_o, turn_o)

    which = np.arange(count) % 8
    grazing = 10 ** rng.uniform(-6, 0, count)
    cos_i = np.where(which % 4 == 1, rng.uniform(0, 1, count), grazing)
    turn_i = np.where(
        which == 3,
        turn_o + np.pi + 10 ** rng.uniform(-7, -1, count),
        rng.uniform(0, 2 * np.pi, count),
    )
    anywhere = unit(np.where(which == 3, np.maximum(cos_o * cos_i, 1e-6), cos_i), turn_i)

    tilt = np.minimum(alpha * 10 ** rng.uniform(-2, 0.7, count), 1.5)
    h = unit(np.cos(tilt), rng.uniform(0, 2 * np.pi, count), np.sin(tilt))
    mirrored = 2 * (wo * h).sum(axis=1, keepdims=True) * h - wo
    near = (which % 2 == 0) & (mirrored[:, 2] > 0)
    wi = np.where(near[:, None], mirrored, anywhere)

    wi, wo = wi.astype(np.float32), wo.astype(np.float32)
    wi[0::per_cell] = wo[0::per_cell] * np.float32([-1, -1, 1])
    wi[1::per_cell] = wo[1::per_cell]
    return alpha.astype(np.float32), wi, wo
