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
# There is no interval where more than this share of windows has its denominator spoiled by noise,
# or where the mean's noise passes this variance: beyond, 1/x makes the figure too large.
UNSTABLE, NOISY = 5e-3, C2 / 2


@dataclass(frozen=True, eq=False)
class Moments:
    """Windowed moments of a truth in two independent halves A and B, each (h, w, 3).

    Outside the object the candidate is the truth itself: A where it meets B and B where it meets
    A, or the noise of the surroundings would count as agreement. The parts of its moments that
    lie out there belong to the truth alone and stand here.

    Attributes:
        middle: (A + B) / 2.
        mean_a, mean_b: windowed means.
        covariance: windowed covariance of A and B: the truth's variance without its noise.
        noise: windowed variance of (A + B) / 2 less that covariance: the noise itself.
        outside_a, outside_b, outside_ab: windowed A, B and A B, of pixels off the object alone.
    """

    middle: np.ndarray
    mean_a: np.ndarray
    mean_b: np.ndarray
    covariance: np.ndarray
    noise: np.ndarray
    outside_a: np.ndarray
    outside_b: np.ndarray
    outside_ab: np.ndarray


def figures(subject: Subject) -> dict[str, Any]:
    """Fields ssim with interval, ssim_raw, ssim_p5 and ssim_highlights, over the eroded mask.

    Where the truth's noise is so large that denominators vanish or the figure is biased, the
    interval is NaN: the figure is then not known, and more samples are needed. ssim_p5 keeps some
    of the noise, which spreads the map.
    """
    truth, core = subject.truth, subject.truth.core
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
    estimate = from_replicates(values[0], values[1:])
    spoiled = _unstable(_variance(candidate, moments[0]), moments[0])[core].mean() > UNSTABLE
    noisy = moments[0].noise[core].mean() > NOISY
    if spoiled or noisy or estimate.value - estimate.half_width > 1:
        return Estimate(estimate.value, float("nan"), float("nan"))
    return estimate


class _Candidate:
    """The candidate's own moments, of its pixels on the object, which no batch changes."""

    def __init__(self, subject: Subject, exposure: float) -> None:
        on_object = subject.truth.mask[..., None]
        self.x = np.where(on_object, display(subject.candidate, exposure), 0)
        self.mean = _window(self.x)
        self.square = _window(self.x * self.x)


def _variance(candidate: _Candidate, truth: Moments) -> np.ndarray:
    """Windowed variance of the candidate, with the truth around it."""
    mean_a, mean_b = candidate.mean + truth.outside_a, candidate.mean + truth.outside_b
    return candidate.square + truth.outside_ab - mean_a * mean_b


def _similarity(candidate: _Candidate, truth: Moments) -> np.ndarray:
    mean_a, mean_b = candidate.mean + truth.outside_a, candidate.mean + truth.outside_b
    means = mean_a * truth.mean_b + mean_b * truth.mean_a  # twice mean_x mean_y
    product = _window(candidate.x * truth.middle) + truth.outside_ab
    variance = _variance(candidate, truth)
    # The few windows that noise spoils keep it: plain SSIM there moves the mean by less than
    # their share.
    noise = np.where(_unstable(variance, truth), truth.noise, 0)
    above = (means + C1) * (2 * product - means + C2)
    below = (mean_a * mean_b + truth.mean_a * truth.mean_b + C1) * (
        variance + truth.covariance + noise + C2
    )
    return above / below


def _unstable(variance: np.ndarray, truth: Moments) -> np.ndarray:
    """Where noise leaves less of the denominator than variances, never negative, allow: C2."""
    return variance + truth.covariance + C2 < C2 / 2


def _moments(truth: TruthView, exposure: float, replicates: bool = False) -> list[Moments]:
    """Moments of all groups and, if asked, of all but each one; remembered on the truth."""
    groups = grouped(truth.batches, GROUPS)
    numbers = np.arange(len(groups))
    wanted = [None, *numbers] if replicates and len(groups) >= 4 else [None]
    known, outside = truth.moments, ~truth.mask[..., None]
    for left_out in wanted:
        if (exposure, left_out) not in known:
            keep = numbers[numbers != left_out] if left_out is not None else numbers
            even, odd = keep[keep % 2 == 0], keep[keep % 2 == 1]
            a = display(groups[even].mean(axis=0), exposure)
            b = display(groups[odd].mean(axis=0), exposure) if len(odd) else a
            middle, mean_a, mean_b, both = (a + b) / 2, _window(a), _window(b), a * b
            covariance = _window(both) - mean_a * mean_b
            variance = _window(middle * middle) - ((mean_a + mean_b) / 2) ** 2
            known[exposure, left_out] = Moments(
                middle,
                mean_a,
                mean_b,
                covariance,
                variance - covariance,
                *(_window(image * outside) for image in (a, b, both)),
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
