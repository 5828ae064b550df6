"""Energy error: reflected light in total and in blocks, candidate over truth."""

import math
from typing import Any

import numpy as np

from reports.metrics.subject import Subject
from reports.noise import (
    Estimate,
    combined,
    corrected,
    jackknife,
    pairs,
    pairs_without_each,
    unknown,
    without_each,
)

BLOCK = 16
# A block whose light has more than this standard error cannot divide: 1/x is then too large by
# more than its square, 4 %, and its spread says less than the truth of its own.
UNSTABLE = 0.2
SHARE = 0.01  # of the object in such blocks: beyond, local energy has no interval


def figures(subject: Subject) -> dict[str, Any]:
    """Fields energy_error (with channels) and energy_local, as fractions: 0.01 is 1 %.

    energy_local_se is the standard error of the square of energy_local, which is what noise
    leaves symmetric.
    """
    total = energy_error(subject)
    channels = [energy_error(subject, channel) for channel in range(3)]
    square = energy_local(subject)
    local = rooted(square)
    return {
        "energy_error": total.value,
        "energy_ci95": total.interval(),
        "energy_se": total.se,
        "energy_dof": total.dof,
        "energy_rgb": tuple(c.value for c in channels),
        "energy_rgb_ci95": tuple(c.interval() for c in channels),
        "energy_local": local[0],
        "energy_local_ci95": local[1:],
        "energy_local_se": square.se,
        "energy_local_dof": square.dof,
    }


def energy_error(subject: Subject, channel: int | None = None) -> Estimate:
    """Sum over the mask of one channel, or of the mean of all; candidate over truth, minus 1."""
    mask = subject.truth.mask

    def light(pixels: np.ndarray) -> np.ndarray:
        return pixels.mean(axis=-1, dtype=np.float64) if channel is None else pixels[..., channel]

    candidate = float(light(subject.candidate[mask]).sum(dtype=np.float64))
    pixels = light(subject.truth.batches[:, mask])
    truth = float(pixels.sum(dtype=np.float64)) / len(pixels)
    if truth <= 0:
        return Estimate(0.0 if candidate == 0 else math.inf)
    if len(pixels) < 2:
        return unknown(candidate / truth - 1)
    se, dof = combined(pixels.var(axis=0, ddof=1, dtype=np.float64) / len(pixels), len(pixels) - 1)
    if se > UNSTABLE * truth:
        return unknown(candidate / truth - 1)
    # 1/x is convex: the mean of 1 / truth is too large by the squared relative error.
    relative = candidate / truth * (1 - (se / truth) ** 2)
    return Estimate(relative - 1, relative * se / truth, dof)


def energy_local(subject: Subject) -> Estimate:
    """Mean square of the energy error over 16x16 blocks, the worst channel, without noise.

    The square is estimated without bias from pairs of batches, and may come out below zero. Light
    in a channel where the truth is black altogether counts as infinite. Blocks share no pixel, so
    their variances add up. Where the error is nought the jackknife gives up to twice the variance,
    which is left standing, for the sake of heavy tails.
    """
    pixels, candidate, batches = _blocks(subject)
    if candidate[:, batches.sum(axis=(0, 1)) == 0].any():
        return Estimate(math.inf)
    errors = candidate - batches
    products = errors[:, None] * errors
    truth = batches.mean(axis=0)
    blocks = block_weights(pixels, truth) * pairs(products)
    worst = worst_channel(pixels, candidate, batches)
    if len(batches) < 3:
        return unknown(float(blocks.sum(axis=0)[worst]))
    replicates = block_weights(pixels, without_each(batches)) * pairs_without_each(products)
    value = float(corrected(blocks, replicates)[:, worst].sum())
    noise = batches.std(axis=0, ddof=1) / math.sqrt(len(batches))
    unstable = (noise > UNSTABLE * truth) & (truth > 0)
    if pixels[unstable[:, worst]].sum() > SHARE * pixels.sum():
        return unknown(value)
    return Estimate(value, *combined(jackknife(replicates)[:, worst], len(batches) - 1))


def block_weights(pixels: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """What a squared difference of light in a block counts, (..., b, 3).

    Blocks count by their pixels on the object, (b,), and differences relative to the truth's light
    in the block, (..., b, 3), or in the channel's mean block where the truth has none. A channel
    that is black altogether counts nothing.
    """
    mean = truth.mean(axis=-2, keepdims=True)
    scale = np.where(truth > 0, truth, np.where(mean > 0, mean, np.inf))
    return (pixels / pixels.sum())[:, None] / scale**2


def worst_channel(pixels: np.ndarray, candidate: np.ndarray, batches: np.ndarray) -> int:
    """The channel whose local energy error is the largest.

    Args:
        pixels, candidate, batches: of the object's blocks, (b,), (b, 3) and (n, b, 3).
    """
    errors = candidate - batches
    squares = block_weights(pixels, batches.mean(axis=0)) * pairs(errors[:, None] * errors)
    return int(np.argmax(squares.sum(axis=0)))


def rooted(square: Estimate) -> tuple[float, float, float]:
    """Root of a mean square with its 95 % interval; 0 where noise makes it negative."""
    return tuple(math.sqrt(max(s, 0)) if s == s else s for s in (square.value, *square.interval()))


def block_errors(subject: Subject) -> np.ndarray:
    """The signed energy error of each block spread over its pixels, (h, w); NaN off the object."""
    mask = subject.truth.mask
    labels = block_labels(mask.shape, subject.truth.corner)
    candidate = np.bincount(labels[mask], subject.candidate[mask].mean(axis=1))
    truth = np.bincount(labels[mask], subject.truth.mean[mask].mean(axis=1))
    errors = candidate / np.maximum(truth, 1e-30) - 1
    return np.where(mask, errors[np.where(mask, labels, 0)], np.nan)


def paired_squares(
    old: Subject, new: Subject, group: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Squared relative errors of two pictures in the blocks of one truth.

    The noise of the truth is taken out of the old picture's squares, by pairs of batches, and falls
    out of the difference between the two.

    Returns:
        Squares of the old and of the new picture times the blocks' pixels, (b, 3) each, those
        pixels (b,), and in which larger block, of `group` pixels aside, a multiple of
        BLOCK, each lies, (b,).
    """
    pixels, before, batches = _blocks(old)
    after, truth = _blocks(new)[1], batches.mean(axis=0)
    weights = block_weights(pixels, truth) * pixels.sum()
    errors = before - batches
    squares = weights * pairs(errors[:, None] * errors)
    apart = weights * (after - before) * (after + before - 2 * truth)
    mask, corner = old.truth.mask, old.truth.corner
    inverse, count = _numbered(block_labels(mask.shape, corner)[mask])
    owners = np.zeros(count, int)
    owners[inverse] = block_labels(mask.shape, corner, group)[mask]
    return squares, squares + apart, pixels, owners


def block_sums(pixels: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Pixels (H, W, 3 or 1) of a whole picture summed over an object's blocks, (3 blocks,)."""
    labels, count = _numbered(block_labels(mask.shape)[mask])
    inside = np.broadcast_to(pixels, (*mask.shape, 3))[mask]
    return np.stack([np.bincount(labels, c, count) for c in inside.T], axis=1).ravel()


def _numbered(labels: np.ndarray) -> tuple[np.ndarray, int]:
    """Labels as numbers from 0, and how many there are."""
    found, inverse = np.unique(labels, return_inverse=True)
    return inverse, len(found)


def block_labels(
    shape: tuple[int, int], corner: tuple[int, int] = (0, 0), side: int = BLOCK
) -> np.ndarray:
    """The number of the block that each pixel lies in, (h, w); blocks lie on the picture's grid."""
    rows, columns = (
        (np.arange(size) + start) // side - start // side
        for size, start in zip(shape, corner, strict=True)
    )
    return rows[:, None] * (columns[-1] + 1) + columns


def _blocks(subject: Subject) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pixels (b,), candidate (b, 3) and batches (n, b, 3) summed over the object's blocks."""
    mask = subject.truth.mask
    inverse, count = _numbered(block_labels(mask.shape, subject.truth.corner)[mask])

    def summed(pixels: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(inverse, pixels[:, c], count) for c in range(3)], axis=1)

    batches = np.stack([summed(batch[mask]) for batch in subject.truth.batches])
    return np.bincount(inverse).astype(float), summed(subject.candidate[mask]), batches
