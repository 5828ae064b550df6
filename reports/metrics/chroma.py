"""Chroma error: how much duller or more vivid the object looks, whatever its brightness."""

import math
from typing import Any

import numpy as np
from skimage.color import rgb2lab

from reports.display import display
from reports.metrics.subject import Subject
from reports.noise import Estimate, corrected, jackknife, unknown, without_each

COLOURLESS = 1.0  # CIELAB chroma below which nobody sees a hue, so that no ratio means anything


def figures(subject: Subject) -> dict[str, Any]:
    """Field chroma_error: mean CIELAB chroma on the object, candidate over truth, minus 1.

    After exposure and sRGB, as SSIM sees it; NaN where the truth is grey. Noise makes colours
    look more vivid than they are: that bias is taken out by the jackknife.
    """
    mask, exposure = subject.truth.mask, subject.truth.exposure
    groups = subject.truth.groups[:, mask]
    ours, truth = _chroma(subject.candidate[mask], exposure), _chroma(groups.mean(axis=0), exposure)
    if truth < COLOURLESS:
        error = unknown(math.nan)
    elif len(groups) < 2:
        error = unknown(ours / truth - 1)
    else:
        parts = np.array([_chroma(part, exposure) for part in without_each(groups)])
        truth = float(corrected(np.array(truth), parts))
        noise = math.sqrt(jackknife(ours / parts))
        error = Estimate(ours / truth - 1, noise, len(groups) - 1)
    return {"chroma_error": error.value, "chroma_error_ci95": error.interval()}


def _chroma(rgb: np.ndarray, exposure: float) -> float:
    """Mean CIELAB chroma of linear pixels (p, 3) after display."""
    lab = rgb2lab(display(rgb, exposure)[None])[0]
    return float(np.hypot(lab[:, 1], lab[:, 2]).mean())
