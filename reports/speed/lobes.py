"""How many directions a mixture of lobes takes, by the density that they are drawn from.

The paper (III.D) draws from the GGX lobe whatever the mixture: correct, since a density only makes
an integral converge faster, but perhaps with more directions. This measures the claim, in double
precision, for the specular integral at F = 1 under the masking `paper`:

    I(wo) = ∫ D G / (4 n.wi n.wo) L(wi) n.wi dwi = E[ (D / D_s) G wo.h / (n.h n.wo) L ]

over half vectors h of density D_s n.h (Walter et al. 2007, eq. 35 and 28), where D_s is D_ggx,
the mixture w D_ggx + (1 - w) D_beckmann, or D_beckmann.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.spatial.transform import Rotation
from scipy.stats import qmc

from reports.results import Figured
from reports.speed.points import LobeSampling
from scenes.environment import load_environment

ROUGHNESS = (0.2, 0.5, 0.8)
WEIGHTS = (0.0, 0.25, 0.5, 0.75, 1.0)
COSINES = (0.2, 0.9)
SAMPLERS = ("ggx", "mixture", "beckmann")
TOLERANCE = 0.01
SHIFTS = 16  # Hammersley sets, each turned by a random shift (Cranley and Patterson 1976)
LARGEST = 14  # log2 of the largest set that is tried
MOST = 1e9  # random directions; what takes more is told as never
TRUTH = 14  # log2 of the directions of each of SHIFTS sets that the truth is the mean of
TURNS = 8  # orientations of the surface under an environment
RESAMPLINGS = 200

# Radiance (orientations, n) of directions (n, 3) in the tangent frame.
Light = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Facets:
    """Half vectors that were drawn, and the integrand there over D; arrays (n,).

    Attributes:
        t: tan² theta_h / alpha², which both NDFs depend on alone.
        smith, vcavity: G wo.h / (n.h n.wo) for the masking of GGX and of Beckmann.
        light: radiance (orientations, n) from the mirrored direction, 0 below the horizon.
    """

    t: np.ndarray
    smith: np.ndarray
    vcavity: np.ndarray
    light: np.ndarray

    @cached_property
    def lobes(self) -> tuple[np.ndarray, np.ndarray]:
        """D_ggx and D_beckmann, both times pi alpha² cos⁴ theta_h; never quite 0."""
        return 1 / (1 + self.t) ** 2, np.maximum(np.exp(-self.t), 1e-300)

    def values(self, weight: float, sampler: str) -> np.ndarray:
        """What each half vector adds, if it was drawn by `sampler`, (orientations, n)."""
        ggx, beckmann = self.lobes
        D = weight * ggx + (1 - weight) * beckmann
        density = {"ggx": ggx, "mixture": D, "beckmann": beckmann}[sampler]
        masked = weight * self.smith + (1 - weight) * self.vcavity
        return D / density * masked * self.light


def facets(u: np.ndarray, cosine: float, alpha: float, weight: float, light: Light) -> Facets:
    """Half vectors from points u (n, 2) of the unit square: `weight` of them from the GGX lobe.

    The first coordinate chooses the lobe and is stretched again, so that even points stay even.
    """
    first = u[:, 0] < weight
    v = np.where(first, u[:, 0] / max(weight, 1e-300), (u[:, 0] - weight) / max(1 - weight, 1e-300))
    v = np.minimum(v, 1 - 1e-16)
    t = np.where(first, v / (1 - v), -np.log1p(-v))
    cos_h, phi = 1 / np.sqrt(1 + alpha**2 * t), 2 * np.pi * u[:, 1]
    sin_h = np.sqrt(1 - cos_h**2)
    h = np.stack([sin_h * np.cos(phi), sin_h * np.sin(phi), cos_h], axis=1)
    wo = np.array([np.sqrt(1 - cosine**2), 0.0, cosine])
    wo_h = h @ wo
    wi = 2 * wo_h[:, None] * h - wo
    lit = (wo_h > 0) & (wi[:, 2] > 0)
    cos_i = np.where(lit, wi[:, 2], 1.0)
    base = np.where(lit, wo_h / (cos_h * cosine), 0.0)
    smith = _smith(cosine, alpha) * _smith(cos_i, alpha)
    open_share = 2 * cos_h * np.minimum(cos_i, cosine) / np.where(lit, wo_h, 1.0)
    return Facets(t, base * smith, base * np.minimum(1, open_share), light(wi))


def _smith(cosine: np.ndarray | float, alpha: float) -> np.ndarray:
    """G1 of GGX, Walter et al. 2007, eq. 34."""
    return 2 / (1 + np.sqrt(1 + alpha**2 * (1 / cosine**2 - 1)))


def furnace(wi: np.ndarray) -> np.ndarray:
    """Radiance 1 from everywhere."""
    return np.ones((1, len(wi)))


def environment(path: Path, frames: np.ndarray) -> Light:
    """An environment's mean of R, G, B, around surfaces in frames (orientations, 3, 3)."""
    radiance = load_environment(path).radiance.mean(axis=2)
    height, width = radiance.shape

    def light(wi: np.ndarray) -> np.ndarray:
        x, y, z = np.einsum("tij,nj->itn", frames, wi)
        row = np.arctan2(np.hypot(x, y), z) / np.pi * (height - 1)
        column = np.arctan2(x, y) / (2 * np.pi) * width - 0.5
        return map_coordinates(radiance, (row, column), order=1, mode="grid-wrap")

    return light


def hammersley(count: int, shift: np.ndarray) -> np.ndarray:
    """The Hammersley set (count, 2), turned by a shift (2,)."""
    first = (np.arange(count) + 0.5) / count
    second = qmc.Halton(1, scramble=False).random(count)[:, 0]  # the radical inverse to base 2
    return (np.stack([first, second], axis=1) + shift) % 1


def needed(squares: np.ndarray, tolerance: float = TOLERANCE) -> float:
    """The size from which the RMS error stays within the tolerance, on a log-log line.

    Args:
        squares: (k,) mean squared relative errors of 1, 2, 4, ... directions.

    Returns:
        Infinity if the largest size is not enough, 1 if one direction is.
    """
    above = np.flatnonzero(squares > tolerance**2)
    if not above.size:
        return 1.0
    last = int(above[-1])
    if last == len(squares) - 1:
        return np.inf
    here, there = np.log(np.maximum(squares[last : last + 2], 1e-300)) / 2
    return float(2 ** (last + (here - np.log(tolerance)) / (here - there)))


def lobe_sampling(
    environments: tuple[Path, ...] = (),
    roughness: tuple[float, ...] = ROUGHNESS,
    largest: int = LARGEST,
) -> list[LobeSampling]:
    """Directions to 1 % RMS over roughness, angle, weight, sampler, points and light.

    Args:
        environments: maps to measure under besides the furnace.
        largest: log2 of the largest Hammersley set.
    """
    frames = Rotation.random(TURNS, rng=np.random.default_rng(0)).as_matrix()
    lights = {"furnace": furnace} | {path.stem: environment(path, frames) for path in environments}
    return [
        found
        for name, light in lights.items()
        for rough in roughness
        for cosine in COSINES
        for found in _measured(rough, cosine, name, light, largest)
    ]


def _measured(
    roughness: float, cosine: float, name: str, light: Light, largest: int
) -> list[LobeSampling]:
    rng, alpha = np.random.default_rng(1), roughness**2
    shifts = rng.random((SHIFTS, 2))
    truths, moments = _truths(cosine, alpha, light, shifts)
    picks = rng.integers(SHIFTS, size=(RESAMPLINGS, SHIFTS))
    made = []
    # The sets of one lobe serve every weight; those of a mixture belong to it.
    squares = {
        key: _squares(key, truths, cosine, alpha, light, shifts, largest)
        for key in ("ggx", "beckmann", *WEIGHTS)
    }
    for k, weight in enumerate(WEIGHTS):
        for sampler in SAMPLERS:
            found = squares[weight if sampler == "mixture" else sampler][k]
            drawn = [needed(found[:, pick].mean(axis=1)) for pick in picks]
            hammersley_needs = _figured(needed(found.mean(axis=1)), drawn)
            second, mean = moments[sampler][k], truths[k]
            variances = (second - mean**2).mean(axis=1) / (mean**2).mean()
            drawn = [variances[pick].mean() / TOLERANCE**2 for pick in picks]
            random_needs = _figured(variances.mean() / TOLERANCE**2, drawn)
            for points, needs in (("Hammersley", hammersley_needs), ("random", random_needs)):
                made.append(
                    LobeSampling(
                        roughness=roughness,
                        weight=weight,
                        cos_theta=cosine,
                        sampler=sampler,
                        points=points,
                        light=name,
                        samples=needs,
                    )
                )
    return made


def _figured(value: float, drawn: list[float]) -> Figured:
    low, high = np.quantile(drawn, [0.025, 0.975], method="nearest")
    return Figured(**{n: _told(v) for n, v in (("value", value), ("low", low), ("high", high))})


def _told(count: float) -> float:
    return max(float(count), 1.0) if count <= MOST else np.inf


def _truths(
    cosine: float, alpha: float, light: Light, shifts: np.ndarray
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """The integrals (weights, orientations), and what the variance of random points takes.

    Returns:
        Beside the integrals, by sampler, E[value²] (weights, shifts, orientations): drawn from
        GGX, whose tail covers what the others would never find.
    """
    means, seconds = [], {s: [] for s in SAMPLERS}
    for shift in shifts:
        drawn = facets(hammersley(2**TRUTH, shift), cosine, alpha, 1.0, light)
        values = {s: np.stack([drawn.values(w, s) for w in WEIGHTS]) for s in SAMPLERS}
        means.append(values["ggx"].mean(axis=-1))
        with np.errstate(over="ignore"):
            for sampler in SAMPLERS:
                seconds[sampler].append((values["ggx"] * values[sampler]).mean(axis=-1))
    return np.mean(means, axis=0), {s: np.stack(v, axis=1) for s, v in seconds.items()}


def _squares(
    key: str | float,
    truths: np.ndarray,
    cosine: float,
    alpha: float,
    light: Light,
    shifts: np.ndarray,
    largest: int,
) -> np.ndarray:
    """Squared relative errors (weights, sizes, shifts) of sets drawn from one lobe or mixture.

    Orientations are averaged: a share of their mean square, so that dark ones do not decide.
    """
    share = {"ggx": 1.0, "beckmann": 0.0}.get(key, key)
    sampler = key if isinstance(key, str) else "mixture"
    found = np.zeros((len(WEIGHTS), largest + 1, len(shifts)))
    for size in range(largest + 1):
        for number, shift in enumerate(shifts):
            drawn = facets(hammersley(2**size, shift), cosine, alpha, share, light)
            for k, weight in enumerate(WEIGHTS):
                if sampler == "mixture" and weight != key:
                    continue
                off = drawn.values(weight, sampler).mean(axis=-1) - truths[k]
                found[k, size, number] = (off**2).mean() / (truths[k] ** 2).mean()
    return found
