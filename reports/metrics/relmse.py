"""Relative squared error per pixel, without the reference's noise."""

from typing import Any

import numpy as np

from reports.metrics.subject import Subject
from reports.noise import unbiased_square


def figures(subject: Subject) -> dict[str, Any]:
    """Fields relmse and relmse_median over the object's pixels and channels.

    (candidate - truth)² / (truth² + (0.01 mean)²), Rousselle et al. 2011 with the guard scaled
    to the object's mean radiance, so that the figure does not depend on the exposure. The median
    stands beside the mean, which a few glints can carry.
    """
    mask = subject.truth.mask
    batches, truth = subject.truth.batches[:, mask], subject.truth.mean[mask]
    squares = unbiased_square(subject.candidate[mask] - batches)
    relative = squares / np.maximum(truth**2 + (0.01 * truth.mean()) ** 2, 1e-30)
    return {"relmse": float(relative.mean()), "relmse_median": float(np.median(relative))}
