"""Energy error: reflected light in total and in blocks, candidate over truth."""

from typing import Any

import numpy as np

from reports.metrics.subject import Subject
from reports.noise import Estimate, jackknife, unbiased_square

BLOCK = 16


def figures(subject: Subject) -> dict[str, Any]:
    """Fields energy_error (with channels) and energy_local, as fractions: 0.01 is 1 %."""
    total = energy_error(subject)
    local = energy_local(subject)
    mask, truth = subject.truth.mask, subject.truth.mean
    channels = subject.candidate[mask].sum(axis=0) / np.maximum(truth[mask].sum(axis=0), 1e-30) - 1
    return {
        "energy_error": total.value,
        "energy_ci95": (total.low, total.high),
        "energy_rgb": tuple(float(c) for c in channels),
        "energy_local": local.value,
        "energy_local_ci95": (local.low, local.high),
    }


def energy_error(subject: Subject) -> Estimate:
    """Sum over the mask of the mean of R, G and B, candidate over truth, minus 1, signed."""
    mask = subject.truth.mask
    light = float(subject.candidate[mask].mean(axis=1, dtype=np.float64).sum())
    lights = subject.truth.batches[:, mask].mean(axis=2, dtype=np.float64).sum(axis=1)
    if lights.mean() <= 0:
        value = 0.0 if light == 0 else float("inf")
        return Estimate(value, value, value)
    return jackknife(lambda keep: light / lights[keep].mean() - 1, len(lights))


def energy_local(subject: Subject) -> Estimate:
    """Root mean square of the energy error over 16x16 blocks, the worst channel, without noise.

    Blocks count by their pixels on the object. The square is estimated without bias from pairs
    of batches; where noise makes it negative the figure is 0. Light in a block and channel where
    the truth has none counts against the channel's mean block, or as infinite where the truth is
    black altogether.
    """
    weights, candidate, batches = _blocks(subject)
    black = batches.sum(axis=(0, 1)) == 0
    if candidate[:, black].any():
        return Estimate(float("inf"), float("inf"), float("inf"))

    def squares(keep: np.ndarray) -> np.ndarray:
        kept = batches[keep]
        truth = kept.mean(axis=0)
        scale = np.where(truth > 0, truth, truth.mean(axis=0))
        errors = (candidate - kept) / np.where(black, 1, scale)
        return np.average(unbiased_square(errors), axis=0, weights=weights)

    worst = int(np.argmax(squares(np.arange(len(batches)))))
    square = jackknife(lambda keep: squares(keep)[worst], len(batches))
    return Estimate(*(float(np.sqrt(max(s, 0))) for s in (square.value, square.low, square.high)))


def block_errors(subject: Subject) -> np.ndarray:
    """The signed energy error of each block spread over its pixels, (h, w); NaN off the object."""
    mask = subject.truth.mask
    labels = _labels(subject)
    candidate = np.bincount(labels[mask], subject.candidate[mask].mean(axis=1))
    truth = np.bincount(labels[mask], subject.truth.mean[mask].mean(axis=1))
    errors = candidate / np.maximum(truth, 1e-30) - 1
    return np.where(mask, errors[np.where(mask, labels, 0)], np.nan)


def _labels(subject: Subject) -> np.ndarray:
    """The number of the block that each pixel lies in, (h, w); blocks lie on the picture's grid."""
    height, width = subject.truth.mask.shape
    top, left = subject.truth.corner
    rows = (np.arange(height) + top) // BLOCK - top // BLOCK
    columns = (np.arange(width) + left) // BLOCK - left // BLOCK
    return rows[:, None] * (columns[-1] + 1) + columns


def _blocks(subject: Subject) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pixels (b,), candidate (b, 3) and batches (n, b, 3) summed over the object's blocks."""
    mask = subject.truth.mask
    labels, inverse = np.unique(_labels(subject)[mask], return_inverse=True)

    def summed(pixels: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(inverse, pixels[:, c], len(labels)) for c in range(3)], axis=1)

    batches = np.stack([summed(batch[mask]) for batch in subject.truth.batches])
    return np.bincount(inverse).astype(float), summed(subject.candidate[mask]), batches
