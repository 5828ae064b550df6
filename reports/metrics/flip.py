"""HDR-FLIP (Andersson et al. 2021) at the two exposures that SSIM uses."""

from typing import Any

import flip_evaluator
import numpy as np

from reports.metrics.subject import Subject
from reports.noise import combined, quantile

PIXELS_PER_DEGREE = 67.0  # the tool's own default: 0.7 m from a 4K display 0.7 m wide
SLOWEST = 0.35  # power of 1/n at which noise leaves the map at least
APART = 12  # rows around pictures above each other; FLIP's filters reach 10 at this setting
BLOCK = 32  # several times that reach: blocks of the map share little noise


def figures(subject: Subject) -> dict[str, Any]:
    """Field flip: mean over the object of the HDR-FLIP map, 0 (same) to 1, with bounds.

    FLIP is the size of a difference, so the truth's noise adds to it and cannot be taken out as
    from a square: its part falls as 1/n where the difference is larger than the noise, and as
    n^-.35 where it is smaller, since differences of colour are raised to the power .7. The figure
    supposes the former. Its bounds hold both: below, what the latter leaves, above, the figure
    with all the noise, each with its 95 % interval.
    """
    mask, batches = subject.truth.mask, subject.truth.batches
    if len(batches) < 2:
        return {"flip": float(flip_map(subject)[mask].mean())}
    count = len(batches) // 2 * 2
    whole, half = _maps(subject, [subject.truth.mean, batches[0:count:2].mean(axis=0)])
    # A half differs from the whole as the whole from the truth: the map's noise, block by block.
    blocks = _labels(mask.shape)[mask]
    apart = np.bincount(blocks, (half - whole)[mask]) / mask.sum()
    se, dof = combined(apart**2, 1)
    reach = se * quantile(0.95, dof)
    flip, noisier = float(whole[mask].mean()), float(half[mask].mean())
    rise = max(noisier - flip, 0.0)
    return {
        "flip": max(flip - rise, 0.0),
        "flip_ci95": (max(flip - rise / (2**SLOWEST - 1) - reach, 0.0), flip + reach),
    }


def flip_map(subject: Subject) -> np.ndarray:
    """The HDR-FLIP map against the mean of all batches, (h, w)."""
    return _maps(subject, [subject.truth.mean])[0]


def _maps(subject: Subject, truths: list[np.ndarray]) -> list[np.ndarray]:
    """HDR-FLIP maps, (h, w) each, with exposures given, since automatic ones can be infinite.

    One above the other, apart by their outer rows repeated: a call takes 0.2 s however small.
    """
    on_object = subject.truth.mask[..., None]
    candidates = [np.where(on_object, subject.candidate, truth) for truth in truths]
    stops = float(np.log2(subject.truth.exposure))
    error, _, _ = flip_evaluator.evaluate(
        _stacked(truths),
        _stacked(candidates),
        "HDR",
        inputsRGB=False,
        applyMagma=False,
        computeMeanError=False,
        parameters={
            "ppd": PIXELS_PER_DEGREE,
            "startExposure": stops - 3,
            "stopExposure": stops,
            "numExposures": 2,
        },
    )
    height = len(subject.truth.mask)
    starts = range(APART, len(error), height + 2 * APART)
    return [error[start : start + height, :, 0] for start in starts]


def _stacked(images: list[np.ndarray]) -> np.ndarray:
    edges = ((APART, APART), (0, 0), (0, 0))
    padded = [np.pad(np.clip(image, 0, None), edges, mode="edge") for image in images]
    return np.ascontiguousarray(np.concatenate(padded), np.float32)


def _labels(shape: tuple[int, int]) -> np.ndarray:
    rows, columns = np.indices(shape) // BLOCK
    return rows * (shape[1] // BLOCK + 1) + columns
