"""Surfaces and pairs of directions on which the sides are compared."""

import numpy as np

from scenes.schema import Material

ALPHAS = (0.01, 0.05, 0.16, 0.49, 1.0)
WEIGHTS = (0.0, 0.25, 0.5, 1.0)
MASKINGS = ("paper", "smith")
GRAZING = 1e-4  # the least cosine for which agreement is promised


def materials() -> list[Material]:
    """Surfaces over alpha and weight, half metal so that every term counts."""
    return [
        Material(
            albedo=(0.6, 0.3, 0.05),
            roughness=np.sqrt(alpha),
            metallic=0.5,
            f0=0.04,
            metal="Cu",
            weight=weight,
        )
        for alpha in ALPHAS
        for weight in WEIGHTS
    ]


def directions(alpha: float, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of unit directions, two (n, 3) float32 arrays, many of them near the lobe's peak.

    Half of the pairs are spread over the hemisphere, down to cosines of 1e-4; the others are
    mirrored about normals within a few alpha of n.
    """
    rng = np.random.default_rng(seed)
    count = 20_000
    cosine = np.concatenate(
        [rng.uniform(GRAZING, 1, count // 2), GRAZING ** rng.uniform(0, 1, count // 2)]
    )
    wo = _direction(cosine, rng.uniform(0, 2 * np.pi, count))
    spread = _direction(rng.permutation(cosine), rng.uniform(0, 2 * np.pi, count))
    tilt = np.minimum(alpha * 10 ** rng.uniform(-2, 0.7, count), 1.5)
    h = _direction(np.cos(tilt), rng.uniform(0, 2 * np.pi, count))
    mirrored = 2 * (wo * h).sum(axis=1, keepdims=True) * h - wo
    wi = np.where((np.arange(count) % 2 == 0)[:, None], spread, mirrored)
    above = wi[:, 2] > GRAZING
    return wi[above].astype(np.float32), wo[above].astype(np.float32)


def _direction(cosine: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
    sine = np.sqrt(1 - cosine**2)
    return np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine], axis=1)
