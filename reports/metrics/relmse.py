"""Relative squared error per pixel, without the reference's noise."""

from typing import Any

import numpy as np

from reports.metrics.subject import Subject
from reports.noise import grouped, unbiased_square

GROUPS = 8


def figures(subject: Subject) -> dict[str, Any]:
    """Fields relmse and relmse_median over the object's pixels and channels.

    (candidate - truth)² / (truth² + (0.01 mean)²), Rousselle et al. 2011 with the guard scaled
    to the object's mean radiance, so that the figure does not depend on the exposure. The median
    stands beside the mean, which a few glints can carry.
    """
    mask = subject.truth.mask
    candidate, batches = subject.candidate[mask], grouped(subject.truth.batches[:, mask], GROUPS)
    guard = (0.01 * batches.mean()) ** 2

    def relative(kept: np.ndarray) -> np.ndarray:
        below = kept.mean(axis=0) ** 2 + guard
        return unbiased_square(candidate - kept) / np.maximum(below, 1e-30)

    whole = relative(batches)
    count = len(batches)
    if count > 2:
        # The truth stands above and below the line: the jackknife takes out what that adds.
        others = sum(relative(np.delete(batches, k, axis=0)) for k in range(count)) / count
        whole = count * whole - (count - 1) * others
    return {"relmse": float(whole.mean()), "relmse_median": float(np.median(whole))}
