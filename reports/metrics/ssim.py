"""SSIM (Wang et al. 2004) per channel after the display transform, without the truth's noise."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter
from skimage.metrics import structural_similarity

from reports.display import display
from reports.metrics.subject import Subject, TruthView
from reports.noise import Estimate, from_replicates, grouped

GROUPS = 8
HIGHLIGHTS = 1 / 8  # three stops darker
C1, C2 = 0.01**2, 0.03**2  # Wang et al. 2004, K1 and K2 for a data range of 1
UNSTABLE = 5e-3  # share of windows whose denominator noise may spoil before there is no interval


@dataclass(frozen=True, eq=False)
class Moments:
    """Windowed moments of a truth in two independent halves A and B, each (h, w, 3).

    Attributes:
        middle: (A + B) / 2.
        mean_a, mean_b: windowed means.
        covariance: windowed covariance of A and B: the truth's variance without its noise.
        variance: windowed variance of (A + B) / 2: the same with its noise.
    """

    middle: np.ndarray
    mean_a: np.ndarray
    mean_b: np.ndarray
    covariance: np.ndarray
    variance: np.ndarray


def figures(subject: Subject) -> dict[str, Any]:
    """Fields ssim with interval, ssim_raw, ssim_p5 and ssim_highlights, over the eroded mask.

    Where the truth's noise is so large that denominators vanish, the interval is NaN: the figure
    is then not known, and more samples are needed.
    """
    truth, core = subject.truth, subject.truth.core
    if not core.any():
        nan = float("nan")
        empty = dict.fromkeys(("ssim", "ssim_raw", "ssim_p5", "ssim_highlights"), nan)
        return empty | {"ssim_ci95": (nan, nan)}
    full = ssim_map(subject, truth.exposure)
    estimate = _estimate(subject)
    return {
        "ssim": estimate.value,
        "ssim_ci95": (estimate.low, estimate.high),
        "ssim_raw": _raw(subject),
        "ssim_p5": float(np.percentile(full.mean(axis=2)[core], 5)),
        "ssim_highlights": float(ssim_map(subject, truth.exposure * HIGHLIGHTS)[core].mean()),
    }


def ssim_map(subject: Subject, exposure: float) -> np.ndarray:
    """SSIM per pixel and channel, (h, w, 3), with the truth's noise taken out.

    The truth's variance and squared mean are taken between two independent halves A and B of its
    batches: cov(A, B) for the variance, mean_A mean_B for the square. With A = B this is the
    SSIM of Wang et al. 2004, eq. 13.
    """
    return _similarity(_Candidate(subject, exposure), _moments(subject.truth, exposure)[0])


def _estimate(subject: Subject) -> Estimate:
    """Mean SSIM over the core with its jackknife interval over groups of batches."""
    core, candidate = subject.truth.core, _Candidate(subject, subject.truth.exposure)
    moments = _moments(subject.truth, subject.truth.exposure, replicates=True)
    values = [float(_similarity(candidate, m)[core].mean()) for m in moments]
    if _unstable(candidate, moments[0])[core].mean() > UNSTABLE:
        return Estimate(values[0], float("nan"), float("nan"))
    return from_replicates(values[0], values[1:])


class _Candidate:
    """The candidate's own moments, which no batch changes."""

    def __init__(self, subject: Subject, exposure: float) -> None:
        self.x = display(subject.joined, exposure)
        self.mean = _window(self.x)
        self.variance = _window(self.x * self.x) - self.mean**2


def _similarity(candidate: _Candidate, truth: Moments) -> np.ndarray:
    mean_y = (truth.mean_a + truth.mean_b) / 2
    covariance = _window(candidate.x * truth.middle) - candidate.mean * mean_y
    above = (2 * candidate.mean * mean_y + C1) * (2 * covariance + C2)
    # The few windows that noise spoils keep it: plain SSIM there moves the mean by less than
    # their share.
    spread = np.where(_unstable(candidate, truth), truth.variance, truth.covariance)
    below = candidate.mean**2 + truth.mean_a * truth.mean_b + C1
    return above / (below * (candidate.variance + spread + C2))


def _unstable(candidate: _Candidate, truth: Moments) -> np.ndarray:
    """Where noise leaves less of the denominator than variances, never negative, allow: C2."""
    return candidate.variance + truth.covariance + C2 < C2 / 2


def _moments(truth: TruthView, exposure: float, replicates: bool = False) -> list[Moments]:
    """Moments of all groups and, if asked, of all but each one; remembered on the truth."""
    groups = grouped(truth.batches, GROUPS)
    numbers = np.arange(len(groups))
    wanted = [None, *numbers] if replicates and len(groups) >= 4 else [None]
    known = truth.moments
    for left_out in wanted:
        if (exposure, left_out) not in known:
            keep = numbers[numbers != left_out] if left_out is not None else numbers
            even, odd = keep[keep % 2 == 0], keep[keep % 2 == 1]
            a = display(groups[even].mean(axis=0), exposure)
            b = display(groups[odd].mean(axis=0), exposure) if len(odd) else a
            middle, mean_a, mean_b = (a + b) / 2, _window(a), _window(b)
            known[exposure, left_out] = Moments(
                middle,
                mean_a,
                mean_b,
                _window(a * b) - mean_a * mean_b,
                _window(middle * middle) - ((mean_a + mean_b) / 2) ** 2,
            )
    return [known[exposure, left_out] for left_out in wanted]


def _window(image: np.ndarray) -> np.ndarray:
    """Gaussian window of Wang et al. 2004: sigma 1.5, 11x11, per channel of (h, w, 3)."""
    return gaussian_filter(image, (1.5, 1.5, 0), truncate=3.5)


def _raw(subject: Subject) -> float:
    """Plain SSIM against the mean of all batches, by scikit-image."""
    _, full = structural_similarity(
        display(subject.truth.mean, subject.truth.exposure),
        display(subject.joined, subject.truth.exposure),
        gaussian_weights=True,
        sigma=1.5,
        use_sample_covariance=False,
        data_range=1,
        channel_axis=2,
        full=True,
    )
    return float(full[subject.truth.core].mean())
