"""Bright lights taken out of an environment: what is far above its mean, in a few clusters.

A sample of a lobe stands for a share of its directions and sees the light blurred by that much
(`blurred`). Of a light far smaller than that it would show a disc, as far off as samples lie apart.
So each light leaves the environment at those levels whose shares are larger than it is, and is
shaded there as a point instead: a balance heuristic (Veach and Guibas 1995) with the inverse of a
light's solid angle for the density of its one sample.
"""

from dataclasses import dataclass

import numpy as np

BRIGHT = 4.0  # times the mean of what is left
PASSES = 4  # of finding that mean: the brightest lights would hide the others
MOST = 64  # as in lights.glsl
# A cluster is small enough where its power times its variance (radians²) is at most this share of
# all of the environment's power: of plain skies few lights are left.
SMALL = 3e-5


@dataclass(frozen=True, eq=False)
class Lights:
    """The bright lights of an environment.

    Attributes:
        directions: (n, 3), unit, as in an environment that is not turned.
        irradiance: (n, 3) linear RGB on a surface that faces the light.
        solid_angle: (n,) steradians that each spans: of a lamp in its glow, about the lamp's.
        radiance: (H, W, 3), the map that they are taken from.
        excess: (H, W, 3), what of it they hold.
        label: (H, W), the light that each texel is of, -1 for none.
    """

    directions: np.ndarray
    irradiance: np.ndarray
    solid_angle: np.ndarray
    radiance: np.ndarray
    excess: np.ndarray
    label: np.ndarray

    def rest(self, gone: np.ndarray) -> np.ndarray:
        """The map (H, W, 3) without those lights that are gone, by (n,) bool."""
        taken = np.append(gone, False)[self.label]  # label -1 is the last
        return self.radiance - np.where(taken[..., None], self.excess, 0)


def texel_angles(height: int, width: int) -> np.ndarray:
    """Solid angle of a texel in each row, (H,): rows are aligned to the poles."""
    edges = np.clip((np.arange(height + 1) - 0.5) / max(height - 1, 1), 0, 1)
    return -np.diff(np.cos(np.pi * edges)) * 2 * np.pi / width


def extract(radiance: np.ndarray, most: int = MOST) -> Lights:
    """Take the lights out of a lat-long map (H, W, 3): radiance above BRIGHT means, by hue.

    Clusters are halved where their power is spread the most, until there are `most` or all are
    SMALL.
    """
    height, width = radiance.shape[:2]
    angles = np.repeat(texel_angles(height, width), width)
    grey = radiance.mean(axis=2, dtype=np.float64).ravel()
    threshold = np.inf
    for _ in range(PASSES):
        threshold = BRIGHT * np.average(np.minimum(grey, threshold), weights=angles)
    places = np.flatnonzero(grey > threshold)
    share = 1 - threshold / np.maximum(grey[places], 1e-30)
    excess = np.zeros_like(radiance)
    excess.reshape(-1, 3)[places] = radiance.reshape(-1, 3)[places] * share[:, None]
    label = np.full(height * width, -1, np.int16)
    directions = _directions(height, width, places)
    power = grey[places] * share * angles[places]
    clusters = _clusters(directions, power, most, SMALL * float(grey @ angles))
    for number, members in enumerate(clusters):
        label[places[members]] = number
    flux = excess.reshape(-1, 3)[places].astype(np.float64) * angles[places, None]
    middles = [power[c] @ directions[c] for c in clusters]
    return Lights(
        np.array([m / np.linalg.norm(m) for m in middles]).reshape(-1, 3),
        np.array([flux[c].sum(axis=0) for c in clusters]).reshape(-1, 3),
        np.array([_effective(power[c], angles[places[c]]) for c in clusters]),
        radiance,
        excess,
        label.reshape(height, width),
    )


def _directions(height: int, width: int, places: np.ndarray) -> np.ndarray:
    """Unit directions (n, 3) of the texels at flat places (n,)."""
    rows, columns = np.divmod(places, width)
    theta = np.pi * rows / max(height - 1, 1)
    phi = 2 * np.pi * (columns + 0.5) / width
    return np.stack([np.sin(phi) * np.sin(theta), np.cos(phi) * np.sin(theta), np.cos(theta)], 1)


def _clusters(
    directions: np.ndarray, power: np.ndarray, most: int, least: float
) -> list[np.ndarray]:
    """Indices of each cluster: the one that spreads its power most is halved, down to `least`."""
    if not len(power):
        return []
    clusters = [np.arange(len(power))]
    spreads = [_spread(directions, power)]
    while len(clusters) < most:
        worst = int(np.argmax([s[0] for s in spreads]))
        if spreads[worst][0] <= least:
            break
        members, (_, middle, axis) = clusters[worst], spreads[worst]
        side = (directions[members] - middle) @ axis > 0
        halves = [members[side], members[~side]]
        clusters[worst : worst + 1] = halves
        spreads[worst : worst + 1] = [_spread(directions[h], power[h]) for h in halves]
    return clusters


def _effective(power: np.ndarray, angles: np.ndarray) -> float:
    """The solid angle of an even light that is as concentrated as these texels."""
    return float(power.sum() ** 2 / (power**2 / angles).sum())


def _spread(directions: np.ndarray, power: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Power times variance along the longest axis; the middle; that axis. 0 of a lone texel."""
    middle = np.average(directions, axis=0, weights=power)
    if len(power) < 2:
        return 0.0, middle, middle
    apart = directions - middle
    values, axes = np.linalg.eigh((apart * power[:, None]).T @ apart)
    return float(values[-1]), middle, axes[:, -1]
