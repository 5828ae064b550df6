"""From what size on is an error caught? Sets of batches, the curve of sizes, and its 95 % point.

A set takes n of the pool's M batches without replacement. So each set is just what n fresh batches
are: no batch stands twice, which would spoil variances, and the expected share of sets that catch
an error is the right one. But sets share batches: they spread less than fresh ones would, by
sqrt(1 - n / M), and the pool's own noise shifts all of them, by sqrt(n / M) of what fresh ones
spread. `Curve.limit` makes up for the one and tells the other.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import brentq, minimize
from scipy.stats import binomtest, norm

SHARE = 0.95  # of the sets, in which an error must be caught
FINE = 1.02  # ratio of the sizes between which the 95 % point lies in the end
NEAR, COARSE = 0.8, 1.1  # from such a share at such a ratio the fit is as good as another size
FIRST_STEP, GROWTH = 1.04, 1.6  # upwards from the noiseless size: 4 %, then larger steps
STRIDE, STEPS = 4, 6  # from the largest size down to a 4000th of it
FIRST_SETS = 20  # of which half must catch an error, or the others are not asked
PASSED, INCONCLUSIVE, CAUGHT = range(3)
LEAST_SPREAD = math.log(FINE) / 8  # a curve steeper than the sizes tried is taken for this steep


def draws(pool: int, count: int, seed: int = 0) -> np.ndarray:
    """Random orders of the batches 0..pool-1, (count, pool): a set is the beginning of a row."""
    rng = np.random.default_rng(seed)
    return np.stack([rng.permutation(pool) for _ in range(count)])


def noiseless(over: Callable[[float], float], largest: float) -> float | None:
    """The size from which on an error is caught; None if not even the largest is.

    Args:
        over: how far an error of some size is beyond its budget, without noise; above 0 it is.
    """
    known: dict[float, float] = {}
    for k in range(STEPS + 1):  # downwards, until one is missed
        known[log := math.log(largest / STRIDE**k)] = over(largest / STRIDE**k)
        if known[log] <= 0:
            break
    else:
        return largest / STRIDE**STEPS
    if len(known) == 1:
        return None
    *_, caught, missed = known

    def bounded(log: float) -> float:
        by = known[log] if log in known else over(math.exp(log))
        return min(max(by, -10.0), 10.0)

    return math.exp(brentq(bounded, missed, caught, xtol=math.log(FINE) / 2))


@dataclass
class Curve:
    """Outcomes by size: of each set that was asked PASSED, INCONCLUSIVE or CAUGHT."""

    outcomes: dict[float, np.ndarray] = field(default_factory=dict)

    @property
    def sizes(self) -> list[float]:
        """The sizes that were tried, rising."""
        return sorted(self.outcomes)

    def share(self, size: float) -> float:
        """Of the sets, those that caught an error of a size that was tried."""
        return float((self.outcomes[size] == CAUGHT).mean())

    def fit(self) -> tuple[float, float]:
        """Mean and spread of the log size from which single sets catch, by maximum likelihood.

        A probit curve in log size (Finney 1971), so that it rises: a figure's noise is close to
        normal, and over so short a way the figure follows the size.
        """
        sizes = np.log(self.sizes)
        caught = np.array([self.share(s) for s in self.sizes])
        asked = np.array([len(self.outcomes[s]) for s in self.sizes])
        middle = np.interp(0.5, np.maximum.accumulate(caught), sizes)

        def surprise(parameters: np.ndarray) -> float:
            scores = (sizes - parameters[0]) / (LEAST_SPREAD + math.exp(parameters[1]))
            told = caught * norm.logcdf(scores) + (1 - caught) * norm.logcdf(-scores)
            return -float(asked @ told)

        found = minimize(surprise, (middle, math.log(0.03)), method="Nelder-Mead").x
        return float(found[0]), LEAST_SPREAD + math.exp(found[1])

    def limit(self, taken: int, pool: int) -> tuple[float | None, float | None, float | None]:
        """The size that is caught 95 times in 100, and its 95 % interval; None where none is.

        Sets of one pool spread less than fresh ones, by sqrt(1 - taken / pool), which is made up
        for. The interval holds what so few sets leave open of a quantile, and that the pool shifts
        all sets together, by sqrt(taken / pool) of the spread. It is never narrower than the two
        sizes that were tried beside the point.

        Args:
            taken: batches in a set.
            pool: batches that they were drawn from.
        """
        often = [s for s in self.sizes if self.share(s) >= SHARE]
        if not often:
            return None, max(self.sizes), None
        middle, spread = self.fit()
        spread /= math.sqrt(1 - taken / pool)
        z, sets = norm.ppf(SHARE), len(self.outcomes[often[0]])
        found = math.exp(middle + z * spread)
        quantile = math.sqrt(SHARE * (1 - SHARE) / sets) / norm.pdf(z)
        reach = math.exp(norm.ppf(0.975) * spread * math.hypot(quantile, math.sqrt(taken / pool)))
        seldom = [s for s in self.sizes if s < often[0]]
        low = min(found / reach, seldom[-1]) if seldom else None
        return found, low, max(found * reach, often[0])


def traced(judge: Callable[[float, slice], np.ndarray], start: float, largest: float) -> Curve:
    """The curve around its 95 % point.

    Upwards from `start` in growing steps until an error is caught often enough, then halving, then
    downwards until it is caught in less than half of the sets.

    Args:
        judge: the outcomes of some of the sets for an error of some size.
    """
    curve = Curve()

    def often(size: float) -> bool:
        curve.outcomes[size] = judge(size, slice(FIRST_SETS))
        if curve.share(size) > 0.5:
            others = judge(size, slice(FIRST_SETS, None))
            curve.outcomes[size] = np.concatenate([curve.outcomes[size], others])
        return curve.share(size) >= SHARE

    size, step, low = min(start, largest), FIRST_STEP, None
    while not often(size):
        if size >= largest:
            return curve
        low, size, step = size, min(size * step, largest), step**GROWTH
    while low and size / low > (FINE if curve.share(low) < NEAR else COARSE):
        middle = math.sqrt(low * size)
        low, size = (low, middle) if often(middle) else (middle, size)
    step = FIRST_STEP
    while curve.share(least := min(curve.outcomes)) >= 0.5 and step < 1e3:
        often(least / step)
        step **= GROWTH
    return curve


def share_interval(hits: int, of: int) -> tuple[float, float]:
    """The 95 % interval of a share (Clopper and Pearson 1934)."""
    found = binomtest(hits, of).proportion_ci(0.95, "exact")
    return float(found.low), float(found.high)
