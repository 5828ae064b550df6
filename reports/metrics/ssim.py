"""SSIM (Wang et al. 2004) per channel after the display transform, without the truth's noise."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter
from skimage.metrics import structural_similarity

from reports.display import display
from reports.metrics.subject import Subject, TruthView
from reports.noise import (
    Estimate,
    combined,
    corrected,
    near_quantile,
    unknown,
    without_each,
)

HIGHLIGHTS = 1 / 8  # three stops darker
WORST = 0.05  # the percentile of ssim_p5
C1, C2 = 0.01**2, 0.03**2  # Wang et al. 2004, K1 and K2 for a data range of 1
# There is no interval where more than this share of windows has its denominator spoiled by noise
# (in the noisier maps too, that the correction for bias needs), or where the mean's noise passes
# this variance: beyond, 1/x makes the figure too large.
UNSTABLE, NOISY = 5e-3, C2 / 2


@dataclass(frozen=True, eq=False)
class Picture:
    """A truth at one exposure, after display, from part of the batches, (h, w, 3).

    Attributes:
        image: display values less the bias that noise under a curved display brings.
        parts: (n, h, w, 3) the same without each of n groups, for the noise of `image`; None
            where nobody asks for it.
    """

    image: np.ndarray
    parts: np.ndarray | None = None

    @classmethod
    def of(cls, groups: np.ndarray, exposure: float) -> "Picture":
        """From groups of batches (n, h, w, 3) in linear radiance."""
        shown = display(groups.mean(axis=0), exposure)
        if len(groups) < 2:
            return cls(shown)
        parts = display(without_each(groups), exposure)
        return cls(corrected(shown, parts), parts)

    @property
    def dof(self) -> int:
        """Degrees of freedom of the noise of each pixel."""
        return len(self.parts) - 1

    def noise(self, gradient: np.ndarray) -> np.ndarray:
        """Variance that each pixel brings to a figure with this gradient, (h, w)."""
        count = len(self.parts)
        effects = np.einsum("khwc,hwc->khw", self.parts - self.parts.mean(axis=0), gradient)
        return (count - 1) / count * np.sum(effects**2, axis=0, dtype=np.float64)


class Moments:
    """Windowed moments of a truth in two independent pictures A and B, each (h, w, 3).

    Outside the object the candidate is the truth itself: A where it meets B and B where it meets
    A, or the noise of the surroundings would count as agreement. The parts of its moments that
    lie out there belong to the truth alone and stand here.

    Attributes:
        mean_a, mean_b: windowed means.
        covariance: windowed covariance of A and B: the truth's variance without its noise.
        outside_a, outside_b, outside_ab: windowed A, B and A B, of pixels off the object alone.
    """

    def __init__(self, a: np.ndarray, b: np.ndarray, mask: np.ndarray) -> None:
        self.a, self.b, self.outside = a, b, ~mask[..., None]
        self.mean_a, self.mean_b = _window(a), _window(b)
        self.covariance = _window(a * b) - self.mean_a * self.mean_b
        self.outside_a, self.outside_b = _window(a * self.outside), _window(b * self.outside)
        self.outside_ab = _window(a * b * self.outside)

    @cached_property
    def noise(self) -> np.ndarray:
        """Windowed variance of (A + B) / 2 less the covariance: the noise itself."""
        middle = (self.a + self.b) / 2
        variance = _window(middle * middle) - ((self.mean_a + self.mean_b) / 2) ** 2
        return variance - self.covariance


class Shown:
    """A truth at one exposure: two halves A and B of its batches, and the halves' own halves."""

    def __init__(self, truth: TruthView, exposure: float) -> None:
        groups, self.mask = truth.groups, truth.mask
        self.all = Picture.of(groups, exposure)
        self.a = Picture.of(groups[::2], exposure)
        self.b = Picture.of(groups[1::2] if len(groups) > 1 else groups, exposure)
        self.pair = Moments(self.a.image, self.b.image, truth.mask)
        self.parts_known = len(groups) >= 4
        self.noisier = []
        if self.parts_known:
            quarters = [Picture.of(groups[k::4], exposure).image for k in range(4)]  # of A, B, A, B
            self.noisier = [
                *(Moments(quarters[k], self.b.image, truth.mask) for k in (0, 2)),
                *(Moments(self.a.image, quarters[k], truth.mask) for k in (1, 3)),
            ]

    @cached_property
    def plain(self) -> Moments:
        """Moments of the mean of all batches with itself, which give the plain SSIM."""
        return Moments(self.all.image, self.all.image, self.mask)


class Map:
    """SSIM of a candidate against one pair of pictures of the truth, and its derivative."""

    def __init__(self, candidate: "_Candidate", truth: Moments) -> None:
        self.candidate, self.truth = candidate, truth
        t = truth
        self.mean_a, self.mean_b = candidate.mean + t.outside_a, candidate.mean + t.outside_b
        means = self.mean_a * t.mean_b + self.mean_b * t.mean_a  # twice mean_x mean_y
        product = _window(candidate.x * (t.a + t.b) / 2) + t.outside_ab
        variance = candidate.square + t.outside_ab - self.mean_a * self.mean_b
        self.above = means + C1, 2 * product - means + C2
        self.below = (
            self.mean_a * self.mean_b + t.mean_a * t.mean_b + C1,
            variance + t.covariance + C2,
        )
        # Variances are never negative: only noise leaves less than C2 of this denominator.
        self.unstable = self.below[1] < C2 / 2
        if self.unstable.any():
            # The few windows that noise spoils keep it: plain SSIM there moves the mean by less
            # than their share.
            self.below = self.below[0], self.below[1] + np.where(self.unstable, t.noise, 0)
        self.value = self.above[0] * self.above[1] / (self.below[0] * self.below[1])

    def gradients(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivative of the weighted sum of the map by each pixel of A and of B, (h, w, 3) each.

        Args:
            weights: (h, w) of the sum, which also averages the channels.
        """
        c, t = self.candidate, self.truth
        weights = (weights[..., None] / 3).astype(np.float32)
        scale = weights / (self.below[0] * self.below[1])
        by_means = scale * (self.above[1] - self.above[0])
        by_product = 2 * scale * self.above[0]
        by_luminance = -weights * self.value / self.below[0]
        by_structure = -weights * self.value / self.below[1]
        product, structure = _window(by_product), _window(by_structure)
        both = by_luminance - by_structure

        def side(mean_x, mean_y, other):
            own = _window(by_means * mean_x + both * mean_y)
            around = _window(by_means * mean_y + both * mean_x)
            return (
                own
                + c.x / 2 * product
                + other * structure
                + t.outside * (around + other * (product + structure))
            )

        return side(self.mean_b, t.mean_b, t.b), side(self.mean_a, t.mean_a, t.a)


class _Candidate:
    """The candidate's own moments, of its pixels on the object, which no batch changes."""

    def __init__(self, subject: Subject, exposure: float) -> None:
        on_object = subject.truth.mask[..., None]
        self.x = np.where(on_object, display(subject.candidate, exposure), 0)
        self.mean = _window(self.x)
        self.square = _window(self.x * self.x)


def _window(image: np.ndarray) -> np.ndarray:
    """Gaussian window of Wang et al. 2004: sigma 1.5, 11x11, per channel of (h, w, 3)."""
    return gaussian_filter(image, (1.5, 1.5, 0), truncate=3.5)


def judged(subject: Subject) -> dict[str, Any]:
    """Field ssim with its interval, over the eroded mask.

    Where the truth's noise is so large that denominators vanish or the figure is biased, the
    interval is NaN: the figure is then not known, and more samples are needed.
    """
    ssim = Maps(subject, subject.truth.exposure).mean()
    return {
        "ssim": ssim.value,
        "ssim_ci95": ssim.interval(),
        "ssim_se": ssim.se,
        "ssim_dof": ssim.dof,
    }


def further(subject: Subject) -> dict[str, Any]:
    """Fields ssim_p5, ssim_highlights and ssim_raw with intervals, as `judged`.

    ssim_raw is the plain figure, noise and all; its interval is for this number of samples.
    """
    bright = Maps(subject, subject.truth.exposure)
    worst, raw = bright.percentile(), bright.raw(_raw(subject))
    dark = Maps(subject, subject.truth.exposure * HIGHLIGHTS).mean()
    return {
        "ssim_raw": raw.value,
        "ssim_raw_ci95": raw.interval(),
        "ssim_p5": worst.value,
        "ssim_p5_ci95": worst.interval(),
        "ssim_highlights": dark.value,
        "ssim_highlights_ci95": dark.interval(),
    }


def figures(subject: Subject) -> dict[str, Any]:
    """All of them."""
    return judged(subject) | further(subject)


def ssim_map(subject: Subject, exposure: float) -> np.ndarray:
    """SSIM per pixel and channel, (h, w, 3), with the truth's noise taken out.

    The truth's variance and squared mean are taken between two independent halves A and B of its
    batches: cov(A, B) for the variance, mean_A mean_B for the square. With A = B this is the
    SSIM of Wang et al. 2004, eq. 13.
    """
    return Map(_Candidate(subject, exposure), shown_at(subject.truth, exposure).pair).value


def shown_at(truth: TruthView, exposure: float) -> Shown:
    """A truth at an exposure; remembered on the truth, since all candidates need it."""
    if exposure not in truth.shown:
        truth.shown[exposure] = Shown(truth, exposure)
    return truth.shown[exposure]


class Maps:
    """SSIM of a candidate at one exposure: its map, its noisier maps, and figures of them."""

    def __init__(self, subject: Subject, exposure: float) -> None:
        self.shown = shown_at(subject.truth, exposure)
        self.core = subject.truth.core
        self.candidate = _Candidate(subject, exposure)
        self.map = Map(self.candidate, self.shown.pair)
        self.noisier = [Map(self.candidate, m) for m in self.shown.noisier]

    @cached_property
    def known(self) -> bool:
        """Whether the truth's noise leaves the denominators, and can be told at all."""
        spoiled = any(m.unstable[self.core].mean() > UNSTABLE for m in self._all)
        noisy = self.shown.pair.noise[self.core].mean() > NOISY
        return not spoiled and not noisy and self.shown.parts_known

    def mean(self) -> Estimate:
        """Mean over the core."""
        values = [float(m.value[self.core].mean(dtype=np.float64)) for m in self._all]
        return self._estimate(values, self.core / self.core.sum())

    def percentile(self) -> Estimate:
        """5th percentile over the core of the mean over channels."""
        values = [m.value.mean(axis=2)[self.core] for m in self._all]
        nearby = [near_quantile(v, WORST, WORST / 2) for v in values]
        # The values around the percentile move as it does and steadier than it.
        around = [float(w @ v) for w, v in zip(nearby, values, strict=True)]
        weights = np.zeros(self.core.shape)
        weights[self.core] = nearby[0]
        found = float(np.percentile(values[0], 100 * WORST))
        shifted = [value + found - around[0] for value in around]
        return self._estimate(shifted, weights).plus(_roughness(around))

    def raw(self, value: float) -> Estimate:
        """A plain SSIM, with the spread that the mean of all batches gives it."""
        if not self.shown.parts_known:
            return unknown(value)
        plain = Map(self.candidate, self.shown.plain)
        gradient = sum(plain.gradients(self.core / self.core.sum()))
        picture = self.shown.all
        return Estimate(value, *combined(picture.noise(gradient), picture.dof))

    @property
    def _all(self) -> list[Map]:
        return [self.map, *self.noisier]

    def _estimate(self, values: list[float], weights: np.ndarray) -> Estimate:
        if not self.known:
            # Nor is there a correction, which expands in the noise.
            return unknown(values[0])
        by_a, by_b = self.map.gradients(weights)
        noises = self.shown.a.noise(by_a), self.shown.b.noise(by_b)
        return Estimate(_debiased(values), *combined(np.stack(noises), self.shown.a.dof))


def _roughness(values: list[float]) -> float:
    """How well the correction of `_debiased` is known, as a standard error.

    Both halves of the batches tell the same bias apart, and a quarter of it may be of higher
    order: at a percentile noise does not enter as smoothly as into a mean.
    """
    if len(values) == 1:
        return 0.0
    by_a, by_b = (sum(values[k : k + 2]) / 2 - values[0] for k in (1, 3))
    return math.hypot(by_a - by_b, (by_a + by_b) / 4)


def _debiased(values: list[float]) -> float:
    """A figure of A and B less the bias that twice the noise in A, then in B, shows.

    Args:
        values: the figure, then those with each half of A in A's place and of B in B's; or
            the figure alone, where there are too few batches to know.
    """
    if len(values) == 1:
        return values[0]
    return 3 * values[0] - sum(values[1:]) / 2


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
