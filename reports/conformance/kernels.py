"""What light is weighted with around an axis, and how samples of it spread."""

from collections.abc import Callable

import numpy as np


def lambert(cosine: np.ndarray) -> np.ndarray:
    """The kernel of irradiance."""
    return np.maximum(cosine, 0)


def reflected(lobe: Callable[..., np.ndarray], alpha: float) -> Callable[[np.ndarray], np.ndarray]:
    """The kernel of a prefiltered map: D(h) n.l / 4 for n = v, so that h lies half way to l."""

    def kernel(cosine: np.ndarray) -> np.ndarray:
        flat = np.clip(cosine.ravel(), -1, 1)
        h = np.stack([np.sqrt((1 - flat) / 2), np.zeros_like(flat), np.sqrt((1 + flat) / 2)], 1)
        with np.errstate(divide="ignore", invalid="ignore"):
            values = np.where(flat > 0, lobe(h, alpha) * flat / 4, 0)
        return values.reshape(cosine.shape)

    return kernel


def cumulated(lobe: str, z: np.ndarray, alpha: float) -> np.ndarray:
    """The share of samples nearer to n than the cosine z, (n,): the integral of their density.

    Of D h.z for `ggx` and `beckmann` (Walter et al. 2007, eq. 35 and 28), of cos / pi for `cosine`.
    """
    sin2 = 1 - z**2
    if lobe == "cosine":
        return sin2
    tan2 = sin2 / z**2
    return tan2 / (alpha**2 + tan2) if lobe == "ggx" else -np.expm1(-tan2 / alpha**2)


def fourth_order(variance: float) -> Callable[[np.ndarray], np.ndarray]:
    """A round kernel of no second moment: (2 - x) exp(-x), x = (1 - cos) / variance an axis."""

    def kernel(cosine: np.ndarray) -> np.ndarray:
        x = (1 - cosine) / variance
        return (2 - x) * np.exp(-x)

    return kernel
