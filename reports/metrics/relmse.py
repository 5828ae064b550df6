"""Relative squared error, without the reference's noise."""

from typing import Any

import numpy as np

from reports.metrics.subject import Subject
from reports.noise import unbiased_square

BLOCK = 8


def figures(subject: Subject) -> dict[str, Any]:
    """Fields relmse and relmse_median over 8x8 blocks of the object, over all channels.

    Squared errors of pixels are averaged over a block and divided by the block's squared mean
    radiance plus (0.01 of the object's)²: relMSE (Rousselle et al. 2011) with a denominator in
    which a pixel's noise hardly counts, so that it cannot pull the figure. The median over blocks
    stands beside the mean, which a few glints can carry.
    """
    mask, truth = subject.truth.mask, subject.truth.mean
    squares = unbiased_square(subject.candidate - subject.truth.batches)
    rows, columns = np.indices(mask.shape) // BLOCK
    _, block, pixels = np.unique(
        (rows * mask.shape[1] + columns)[mask], return_inverse=True, return_counts=True
    )

    def block_means(image: np.ndarray) -> np.ndarray:
        sums = [np.bincount(block, image[mask][:, c], len(pixels)) for c in range(3)]
        return np.stack(sums, axis=1) / pixels[:, None]

    guard = (0.01 * float(truth[mask].mean())) ** 2
    relative = block_means(squares) / np.maximum(block_means(truth) ** 2 + guard, 1e-30)
    return {
        "relmse": float(np.average(relative.mean(axis=1), weights=pixels)),
        "relmse_median": float(np.median(relative)),
    }
