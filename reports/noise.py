"""Figures and intervals from independently seeded batches of a reference."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import stats

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Estimate:
    """A figure with its confidence interval; NaN bounds where noise cannot be told."""

    value: float
    low: float
    high: float

    @property
    def half_width(self) -> float:
        """Half the interval."""
        return (self.high - self.low) / 2


def jackknife(statistic: Callable[[np.ndarray], float], count: int) -> Estimate:
    """A statistic of all batches, with its delete-one jackknife interval (Tukey 1958).

    Args:
        statistic: takes the indices of the batches to use, returns the figure.
        count: how many batches there are; with one there is no interval.
    """
    everything = np.arange(count)
    return from_replicates(
        statistic(everything), [statistic(np.delete(everything, k)) for k in range(count)]
    )


def from_replicates(value: float, replicates: list[float]) -> Estimate:
    """The interval around `value` from its delete-one replicates, by Student's t."""
    count = len(replicates)
    if count < 2:
        return Estimate(float(value), float("nan"), float("nan"))
    spread = np.asarray(replicates, float)
    variance = (count - 1) / count * np.sum((spread - spread.mean()) ** 2)
    reach = stats.t.ppf(0.5 + CONFIDENCE / 2, count - 1) * np.sqrt(variance)
    return Estimate(float(value), float(value - reach), float(value + reach))


def unbiased_square(errors: np.ndarray) -> np.ndarray:
    """Square of the mean error without the variance of that mean.

    Args:
        errors: (n, ...) errors against n independent batches.

    Returns:
        (...) the mean over pairs k != l of errors[k] errors[l]; may be below zero.
    """
    count = len(errors)
    if count < 2:
        return errors[0] ** 2
    total = errors.sum(axis=0)
    return (total**2 - (errors**2).sum(axis=0)) / (count * (count - 1))


def grouped(batches: np.ndarray, groups: int) -> np.ndarray:
    """Batches (n, ...) averaged into at most `groups` groups of equal size, in order.

    What does not fill the groups evenly is left out, so that all have the same variance.
    """
    groups = min(groups, len(batches))
    size = len(batches) // groups
    return batches[: groups * size].reshape(groups, size, *batches.shape[1:]).mean(axis=1)
