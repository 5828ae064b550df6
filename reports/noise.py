"""Figures and intervals from independently seeded batches of a reference.

Two facts carry this. The noise of a batch is independent of other batches, and the noise of a
pixel of that of other pixels: each has its own samples. So the variance of a figure is the sum of
the variances that its cells (pixels, blocks) bring in, each known from a few batches only, but all
together known well: the degrees of freedom add up. docs/noise.md derives and measures it.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Estimate:
    """A figure with its standard error; NaN where noise cannot be told.

    Attributes:
        value: the figure.
        se: its standard error.
        dof: degrees of freedom of that standard error; 0 where it is NaN.
    """

    value: float
    se: float = 0.0
    dof: float = 0.0

    def interval(self, confidence: float = CONFIDENCE) -> tuple[float, float]:
        """The two-sided interval by Student's t; the figure itself where nothing is noisy."""
        if self.se == 0 or math.isinf(self.value):
            return self.value, self.value
        reach = self.se * quantile(confidence, self.dof)
        return self.value - reach, self.value + reach

    def plus(self, moved: float) -> "Estimate":
        """With the size of a correction as one more standard error, where it is a rough one."""
        return replace(self, se=math.hypot(self.se, moved))


def unknown(value: float) -> Estimate:
    """A figure whose noise cannot be told."""
    return Estimate(value, math.nan)


def quantile(confidence: float, dof: float) -> float:
    """How many standard errors a two-sided interval reaches; NaN without degrees of freedom."""
    return float(stats.t.isf((1 - confidence) / 2, dof)) if dof > 0 else math.nan


def sidak(family_error: float, family: int) -> float:
    """Confidence of each of `family` intervals such that all hold but with `family_error`.

    Šidák 1967; also safe for figures that share batches, since their intervals are two-sided.
    """
    return math.exp(math.log1p(-family_error) / family)


def jackknife(replicates: np.ndarray) -> np.ndarray:
    """Tukey's (1958) variance of figures from their n replicates without each batch, (n, ...)."""
    count = len(replicates)
    spread = replicates - replicates.mean(axis=0)
    return (count - 1) / count * np.sum(spread**2, axis=0, dtype=np.float64)


def combined(variances: np.ndarray, dof: float, excess: float = 0.0) -> tuple[float, float]:
    """Standard error and degrees of freedom of a sum over independent cells.

    Args:
        variances: of each cell, from `dof` degrees of freedom each.
        excess: what all of them together are known to be too large by.

    Returns:
        The standard error, and Welch and Satterthwaite's (1946, 1947) degrees of freedom.
    """
    total = float(np.sum(variances, dtype=np.float64))
    if not total > 0:
        return math.sqrt(total) if total == 0 else math.nan, float(dof)
    # The excess is itself an estimate: at most three quarters of the variance are taken away.
    left = max(total - excess, total / 4)
    return math.sqrt(left), float(dof * total**2 / np.sum(np.square(variances, dtype=np.float64)))


def pairs(products: np.ndarray) -> np.ndarray:
    """Mean over pairs k != l of products[k, l], (n, n, ...): a square without its noise's part."""
    count = len(products)
    if count < 2:
        return products[0, 0]
    return _off_diagonal(products).sum(axis=(0, 1)) / (count * (count - 1))


def pairs_without_each(products: np.ndarray) -> np.ndarray:
    """`pairs` without batch k, (n, ...), for every one of the n >= 3."""
    count, off = len(products), _off_diagonal(products)
    left = off.sum(axis=(0, 1)) - 2 * off.sum(axis=1)
    return left / ((count - 1) * (count - 2))


def pairs_excess(products: np.ndarray) -> np.ndarray:
    """By how much the jackknife's variance of `pairs` is too large, (...); 0 below 4 batches.

    Where the mean error is small against its noise, pairs of noises make the variance, and the
    jackknife gives about twice it (Efron and Stein 1981). Without bias the variance is the
    square of `pairs` less the mean over four different batches of products[i, j] products[k, l].
    """
    count, off = len(products), _off_diagonal(products)
    if count < 4:
        return np.zeros(products.shape[2:])
    total, rows = off.sum(axis=(0, 1)), off.sum(axis=1)
    disjoint = total**2 - 4 * (rows**2).sum(axis=0) + 2 * (off**2).sum(axis=(0, 1))
    disjoint /= count * (count - 1) * (count - 2) * (count - 3)
    return jackknife(pairs_without_each(products)) - (pairs(products) ** 2 - disjoint)


def _off_diagonal(products: np.ndarray) -> np.ndarray:
    count = len(products)
    return np.where(
        np.eye(count, dtype=bool).reshape(count, count, *[1] * (products.ndim - 2)), 0, products
    )


def without_each(batches: np.ndarray) -> np.ndarray:
    """The mean of all batches but one, (n, ...), for every one of the n >= 2."""
    return (batches.sum(axis=0) - batches) / (len(batches) - 1)


def corrected(value: np.ndarray, replicates: np.ndarray) -> np.ndarray:
    """A figure (or an array of them) less the bias that its jackknife shows (Quenouille 1956)."""
    count = len(replicates)
    return count * value - (count - 1) * replicates.mean(axis=0)


def near_quantile(values: np.ndarray, share: float, reach: float) -> np.ndarray:
    """Weights (m,) of what moves the quantile of values (m,): equal next to it, 0 elsewhere.

    A quantile moves as the mean of the values around it; `reach` is the share of all on each side.
    """
    ranks = stats.rankdata(values, method="ordinal") / len(values)
    near = np.abs(ranks - share) <= max(reach, 1 / len(values))
    return near / near.sum()


def grouped(batches: np.ndarray, groups: int) -> np.ndarray:
    """Batches (n, ...) averaged into at most `groups` groups of equal size, in order.

    What does not fill the groups evenly is left out, so that all have the same variance.
    """
    groups = min(groups, len(batches))
    size = len(batches) // groups
    return batches[: groups * size].reshape(groups, size, *batches.shape[1:]).mean(axis=1)
