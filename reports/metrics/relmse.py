"""Relative squared error, without the reference's noise."""

from typing import Any

import numpy as np

from reports.metrics.subject import Subject
from reports.noise import (
    Estimate,
    combined,
    corrected,
    jackknife,
    near_quantile,
    pairs,
    pairs_excess,
    pairs_without_each,
    unknown,
    without_each,
)

BLOCK = 8
TAKEN = 0.5  # of the jackknife's excess; taken in full, silver's heavy tails are not covered
MIDDLE = 0.1  # share of the blocks on each side of the median whose noise moves it


def figures(subject: Subject) -> dict[str, Any]:
    """Fields relmse and relmse_median, with intervals, over 8x8 blocks of the object.

    Squared errors of pixels are averaged over a block and its channels and divided by the squared
    mean radiance there plus (0.01 of the object's)²: relMSE (Rousselle et al. 2011) with a
    denominator in which a pixel's noise hardly counts, so that it cannot pull the figure. The
    median over blocks stands beside the mean, which a few glints can carry.
    """
    products, light, pixels = _blocks(subject)
    guard = (0.01 * np.average(light.mean(axis=0), axis=0, weights=pixels).mean()) ** 2
    weights = pixels / pixels.sum()

    def relative(squares: np.ndarray, truth: np.ndarray) -> np.ndarray:
        return squares / np.maximum(truth**2 + guard, 1e-30)

    truth = light.mean(axis=0)
    blocks = relative(pairs(products), truth).mean(axis=1)
    median = float(np.median(blocks))
    if len(light) < 4:
        return _fields(unknown(float(weights @ blocks)), unknown(median))
    # Channels of a block share its noise: they are added before anything is squared.
    replicates = relative(pairs_without_each(products), without_each(light)).mean(axis=2)
    variances, dof = jackknife(replicates), len(light) - 1
    # Excess of the sum over channels at a denominator that is known.
    excess = pairs_excess((products / np.maximum(truth**2 + guard, 1e-30)).mean(axis=3))
    value = float(weights @ corrected(blocks, replicates))
    near = near_quantile(blocks, 0.5, MIDDLE)
    halves = [
        relative(pairs(products[k::2, k::2]), light[k::2].mean(axis=0)).mean(axis=1) for k in (0, 1)
    ]
    # Noise spreads the blocks, which moves their median. Halves of the batches show about how
    # far, not well enough to correct for it: it counts as noise.
    moved = sum(float(near_quantile(h, 0.5, MIDDLE) @ h) for h in halves) / 2 - float(near @ blocks)
    return _fields(
        Estimate(value, *combined(weights**2 * variances, dof, TAKEN * (weights**2 @ excess))),
        Estimate(median, *combined(near**2 * variances, dof)).plus(2 * moved),
    )


def _fields(mean: Estimate, median: Estimate) -> dict[str, Any]:
    if mean.interval()[1] < 0:  # a square is not: noise is then more than its spread shows
        mean = unknown(mean.value)
    return {
        "relmse": mean.value,
        "relmse_ci95": mean.interval(),
        "relmse_median": median.value,
        "relmse_median_ci95": median.interval(),
    }


def _blocks(subject: Subject) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Means over the object's pixels in each block, and how many those are.

    Returns:
        (g, g, b, 3) products of the errors against every two groups of batches; (g, b, 3)
        radiance of the truth; (b,) pixels.
    """
    mask, groups = subject.truth.mask, subject.truth.groups
    rows, columns = np.indices(mask.shape) // BLOCK
    labels = (rows * mask.shape[1] + columns)[mask]
    order = np.argsort(labels, kind="stable")
    _, starts, pixels = np.unique(labels[order], return_index=True, return_counts=True)

    def means(image: np.ndarray) -> np.ndarray:
        return np.add.reduceat(image, starts, axis=-2, dtype=np.float64) / pixels[:, None]

    truths = groups[:, mask][:, order]
    errors = subject.candidate[mask][order] - truths
    count = len(errors)
    products = np.empty((count, count, len(pixels), 3))
    for k in range(count):
        for other in range(k + 1):
            products[k, other] = products[other, k] = means(errors[k] * errors[other])
    return products, means(truths), pixels
