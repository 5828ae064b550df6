"""How a cost grows with a size: an exponent with its interval, and what does not grow."""

import numpy as np
from scipy.stats import f as f_distribution
from scipy.stats import linregress
from scipy.stats import t as t_distribution

from reports.noise import CONFIDENCE
from reports.results import Figured

FEWEST = 4  # sizes: three parameters and something left to tell the noise by
EXPONENTS = np.linspace(-1, 4, 501)
# Of the cost that grows, at the middle size; none, then from a thousandth to a thousand times it.
BASES = np.concatenate([[0.0], np.logspace(-3, 3, 121)])
SMALLEST = 1e-12  # mean square of log residuals that exact data would leave to the F test


def grows(sizes: list[float], values: list[float]) -> tuple[Figured, float]:
    """The exponent p of cost = base + b size^p with its 95 % interval, and the base.

    Errors are taken as relative, alike at every size. Where an F test at 5 % finds no base, it is
    0 and p the slope of log cost over log size. The interval is that of the profile of the squares
    over p (Bates and Watts 1988, 6.1) with any base from 0 up: Student's interval of the slope
    would hold the exponent in 6 of 10 cases only where there is a base that is not seen.

    Args:
        sizes: greater than 0; sizes without a cost greater than 0 are left out.

    Returns:
        An exponent of NaN if fewer than FEWEST sizes are left.
    """
    x, y = np.asarray(sizes, float), np.asarray(values, float)
    known = np.isfinite(y) & (y > 0)
    x, y = x[known], y[known]
    if len(set(x)) < FEWEST:
        return Figured(value=np.nan, low=np.nan, high=np.nan), 0.0
    log_x, log_y = np.log(x) - np.log(x).mean(), np.log(y)
    line = linregress(log_x, log_y)
    reach = t_distribution.ppf((1 + CONFIDENCE) / 2, len(x) - 2) * line.stderr
    if line.slope <= reach:
        return Figured(value=line.slope, low=line.slope - reach, high=line.slope + reach), 0.0
    straight = np.sum((log_y - line.intercept - line.slope * log_x) ** 2)

    # Squares (bases, exponents) of log cost against log(base + size^p); its mean is b's.
    shape = np.log(BASES[:, None, None] + np.exp(EXPONENTS[:, None] * log_x))
    off = log_y - shape
    squares = ((off - off.mean(axis=-1, keepdims=True)) ** 2).sum(axis=-1)
    profile = squares.min(axis=0)
    least, dof = max(profile.min(), SMALLEST * len(x)), len(x) - 3
    allowed = least * (1 + f_distribution.ppf(CONFIDENCE, 1, dof) / dof)
    low, high = _ends(profile, allowed)
    b, p = np.unravel_index(squares.argmin(), squares.shape)
    if straight <= allowed:
        exponent, base = line.slope, 0.0
    else:
        exponent, base = EXPONENTS[p], BASES[b] * np.exp(off[b, p].mean())
    figured = Figured(value=exponent, low=min(low, exponent), high=max(high, exponent))
    return figured, float(base)


def _ends(profile: np.ndarray, allowed: float) -> tuple[float, float]:
    """Where the profile first and last crosses what is allowed, between exponents by a line."""
    inside = np.flatnonzero(profile <= allowed)
    ends = []
    for within, step in ((inside[0], -1), (inside[-1], 1)):
        beyond = min(max(within + step, 0), len(profile) - 1)
        rise = max(profile[beyond] - profile[within], 1e-300)
        share = min((allowed - profile[within]) / rise, 1.0)
        ends.append(EXPONENTS[within] + share * (EXPONENTS[beyond] - EXPONENTS[within]))
    return ends[0], ends[1]
