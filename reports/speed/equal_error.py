"""What a path tracer needs to be as good as a technique: samples, seconds, and their intervals.

Two laws lead from an error to samples per pixel:

- `power`: the squared error of an estimate without bias falls as k^-p, a straight line in logs. For
  independent samples p is 1; for stratified ones it is somewhat more, so it is fitted with the
  scale. It may be followed beyond the largest k that was measured.
- `monotone`: for 1 - SSIM, and for a denoiser, which has an error of its own, nothing is known but
  that more samples do not make it worse: logs are interpolated between what was measured.

Seconds are interpolated between what was measured, in each round by itself, so that a ratio
compares what the machine did within seconds; beyond the most samples they go on along a line
a + b k, fitted to the round.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from reports.noise import Estimate
from reports.results import Figured

Law = Literal["power", "monotone"]
REPLICATES = 2000
BOUNDS = (2.5, 97.5)


@dataclass(frozen=True, eq=False)
class Curve:
    """Error and time of a path tracer over its samples per pixel.

    Attributes:
        samples: (m,) per pixel, rising, m at least 2.
        errors: (m, s) of s pictures of different seeds; squares under the law `power`.
        noise: (m,) standard error that the truth's noise brings to them.
        seconds: (m, r) of a frame, in each of r rounds.
    """

    samples: np.ndarray
    errors: np.ndarray
    noise: np.ndarray
    seconds: np.ndarray


@dataclass(frozen=True)
class Need:
    """Samples, seconds and their ratio to a frame at equal error.

    `beyond` says that the error lies outside of what was measured: "below" the fewest samples, or
    "above" the most. The figures are NaN then, but above under the law `power`.
    """

    samples: Figured
    seconds: Figured
    ratio: Figured
    beyond: Literal["", "below", "above"] = ""


def need(target: Estimate, frames: np.ndarray, curve: Curve, law: Law, seed: int = 0) -> Need:
    """What a path tracer needs to have a technique's error.

    Args:
        target: the technique's error; its square under the law `power`.
        frames: (r,) seconds of the technique's frames, in the same rounds as the curve's.

    Intervals are 95 %, by a bootstrap (Efron 1979) over the noise of the target, of the curve's
    pictures (parametric in logs: a relative spread that all k share, by Student's t) and over
    the rounds. An end that leaves what the law can tell is infinite above, and below the fewest
    samples that were taken.
    """
    rng = np.random.default_rng(seed)
    logs, spread, dof = _logs(curve)
    drawn = logs + rng.standard_t(dof, (REPLICATES, len(logs))) * spread
    errors = target.value + target.se * rng.standard_normal(REPLICATES)
    errors = np.concatenate([[target.value], errors])
    drawn = np.concatenate([[logs], drawn])
    with np.errstate(invalid="ignore", divide="ignore"):
        goals = np.where(errors > 0, np.log(errors), np.where(np.isnan(errors), np.nan, -np.inf))
    x = np.log(curve.samples)
    if np.isfinite(logs).sum() < 2:
        return Need(UNTOLD, UNTOLD, UNTOLD)
    found = _on_line(x, drawn, spread, goals) if law == "power" else _between(x, drawn, goals)
    if np.isnan(spread[np.isfinite(logs)]).any():
        found[1:] = np.nan
    beyond = "below" if found[0] < x[0] else "above" if found[0] > x[-1] else ""
    if np.isnan(found[0]) or beyond == "below" or np.isinf(found[0]):
        return Need(UNTOLD, UNTOLD, UNTOLD, beyond)
    samples = np.exp(np.maximum(found, x[0]))
    seconds, ratios = _timed(samples, frames, curve, rng)
    return Need(*(_figured(values) for values in (samples, seconds, ratios)), beyond)


UNTOLD = Figured(value=np.nan, low=np.nan, high=np.nan)


def _figured(values: np.ndarray) -> Figured:
    """The first of the values, with the percentiles of the others around it."""
    if np.isnan(values).any():
        return Figured(value=values[0], low=np.nan, high=np.nan)
    low, high = np.percentile(values[1:], BOUNDS, method="nearest")  # infinite ones stay so
    return Figured(value=values[0], low=min(low, values[0]), high=max(high, values[0]))


def _logs(curve: Curve) -> tuple[np.ndarray, np.ndarray, int]:
    """Log of the mean error at each k (m,), its standard error, and the degrees of freedom.

    A k whose error the truth's noise swallows has a NaN log and tells nothing; where that noise is
    unknown, so is the standard error alone.
    """
    means = curve.errors.mean(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        swallowed = means <= 2 * np.nan_to_num(curve.noise)
        logs = np.where(swallowed, np.nan, np.log(means))
        noise = curve.noise / means
        relative = curve.errors.var(axis=1, ddof=1) / means**2
    known = np.isfinite(logs)
    pictures = curve.errors.shape[1]
    pooled = relative[known].mean() if known.any() else np.nan
    return logs, np.sqrt(pooled / pictures + noise**2), max(known.sum() * (pictures - 1), 1)


def _on_line(x: np.ndarray, y: np.ndarray, spread: np.ndarray, goals: np.ndarray) -> np.ndarray:
    """Log samples (n,) at which weighted straight lines through y (n, m) meet the goals (n,)."""
    known = np.isfinite(y[0])
    x, y, weights = x[known], y[:, known], 1 / np.maximum(spread[known], 1e-9) ** 2
    if np.isnan(weights).any():
        weights = np.ones_like(x)
    weights /= weights.sum()
    middle = weights @ x
    slope = (y * weights) @ (x - middle) / (weights @ (x - middle) ** 2)
    # A line that does not fall never gets there.
    return np.where(slope < 0, middle + (goals - y @ weights) / np.minimum(slope, -1e-9), np.inf)


def _between(x: np.ndarray, y: np.ndarray, goals: np.ndarray) -> np.ndarray:
    """Log samples (n,) where falling curves through y (n, m) meet the goals (n,); infinite outside.

    Noise may make a curve rise: the mean of its lower and upper envelope never does.
    """
    known = np.isfinite(y[0])
    x, y = x[known], y[:, known]
    lower = np.minimum.accumulate(y, axis=1)
    upper = np.maximum.accumulate(y[:, ::-1], axis=1)[:, ::-1]
    y = (lower + upper) / 2
    found = np.where(goals > y[:, 0], -np.inf, np.inf)
    for k in reversed(range(len(x) - 1)):  # the fewest samples that will do are found last
        inside = (goals <= y[:, k]) & (goals >= y[:, k + 1])
        drop = np.maximum(y[:, k] - y[:, k + 1], 1e-12)
        share = np.clip((y[:, k] - goals) / drop, 0, 1)
        found = np.where(inside, x[k] + share * (x[k + 1] - x[k]), found)
    return np.where(np.isnan(goals), np.nan, found)


def _timed(
    samples: np.ndarray, frames: np.ndarray, curve: Curve, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Seconds (n,) of pictures of so many samples (n,), and their ratios to a frame.

    The first of each is of all rounds, the others of rounds drawn anew.
    """
    k, taken = curve.samples, curve.seconds
    weights = 1 / np.median(taken, axis=1)  # relative errors count alike
    design = np.stack([np.ones_like(k), k], axis=1) * weights[:, None]
    slopes = (np.linalg.pinv(design) @ (taken * weights[:, None]))[1]
    # (n, r): not every k costs as a line through all of them says (36 more than 16 and 64 do).
    place = np.clip(np.searchsorted(k, samples) - 1, 0, len(k) - 2)
    share = np.clip((samples - k[place]) / (k[place + 1] - k[place]), 0, 1)[:, None]
    rounds = rng.integers(len(frames), size=(len(samples), len(frames)))
    rounds[0] = np.arange(len(frames))
    with np.errstate(invalid="ignore"):
        more = np.maximum(samples - k[-1], 0)[:, None]
        told = (1 - share) * taken[place] + share * taken[place + 1] + more * slopes
    seconds = np.take_along_axis(told, rounds, axis=1)
    return np.median(seconds, axis=1), np.median(seconds / frames[rounds], axis=1)
