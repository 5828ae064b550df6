"""HDR-FLIP (Andersson et al. 2021) at the two exposures that SSIM uses."""

from collections.abc import Sequence
from typing import Any

import flip_evaluator
import numpy as np

from reports.metrics.energy import block_labels
from reports.metrics.subject import Subject
from reports.noise import combined, quantile

PIXELS_PER_DEGREE = 67.0  # the tool's own default: 0.7 m from a 4K display 0.7 m wide
SLOWEST = 0.35  # power of 1/n at which noise leaves the map at least
APART = 12  # pixels around pictures in one call; FLIP's filters reach 10 at this setting
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
        return {"flip": float(flip_maps([subject])[0][mask].mean())}
    count = len(batches) // 2 * 2
    truths = subject.truth.mean, batches[0:count:2].mean(axis=0)
    whole, half = _maps([(subject, truth) for truth in truths])
    # A half differs from the whole as the whole from the truth: the map's noise, block by block.
    blocks = block_labels(mask.shape, side=BLOCK)[mask]
    apart = np.bincount(blocks, (half - whole)[mask]) / mask.sum()
    se, dof = combined(apart**2, 1)
    reach = se * quantile(0.95, dof)
    flip, noisier = float(whole[mask].mean()), float(half[mask].mean())
    rise = max(noisier - flip, 0.0)
    return {
        "flip": max(flip - rise, 0.0),
        "flip_ci95": (max(flip - rise / (2**SLOWEST - 1) - reach, 0.0), flip + reach),
    }


def flip_maps(subjects: Sequence[Subject]) -> list[np.ndarray]:
    """The HDR-FLIP maps against the mean of all batches, (h, w) each."""
    return _maps([(subject, subject.truth.mean) for subject in subjects])


def _maps(pairs: Sequence[tuple[Subject, np.ndarray]]) -> list[np.ndarray]:
    """HDR-FLIP maps, (h, w) each, of subjects against some truths (h, w, 3).

    Exposures are given, since automatic ones can be infinite; and brought to 1, since a call takes
    0.2 s however small, and all pictures share it: one above the other, apart by their outer rows
    and columns repeated.
    """
    widest = max(truth.shape[1] for _, truth in pairs)
    truths, candidates = [], []
    for subject, truth in pairs:
        joined = np.where(subject.truth.mask[..., None], subject.candidate, truth)
        exposure = np.float32(subject.truth.exposure)
        truths.append(_framed(truth * exposure, widest))
        candidates.append(_framed(joined * exposure, widest))
    error, _, _ = flip_evaluator.evaluate(
        np.concatenate(truths),
        np.concatenate(candidates),
        "HDR",
        inputsRGB=False,
        applyMagma=False,
        computeMeanError=False,
        parameters={
            "ppd": PIXELS_PER_DEGREE,
            "startExposure": -3.0,
            "stopExposure": 0.0,
            "numExposures": 2,
        },
    )
    found, row = [], APART
    for _, truth in pairs:
        height, width = truth.shape[:2]
        found.append(error[row : row + height, APART : APART + width, 0])
        row += height + 2 * APART
    return found


def _framed(image: np.ndarray, width: int) -> np.ndarray:
    """An image between its outer pixels repeated, to some width in all."""
    right = width - image.shape[1] + APART
    padded = np.pad(np.clip(image, 0, None), ((APART, APART), (APART, right), (0, 0)), mode="edge")
    return np.ascontiguousarray(padded, np.float32)
