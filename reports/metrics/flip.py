"""HDR-FLIP (Andersson et al. 2021) at the two exposures that SSIM uses."""

from typing import Any

import flip_evaluator
import numpy as np

from reports.metrics.subject import Subject

PIXELS_PER_DEGREE = 67.0  # the tool's own default: 0.7 m from a 4K display 0.7 m wide


def figures(subject: Subject) -> dict[str, Any]:
    """Field flip: mean over the object of the HDR-FLIP map, 0 (same) to 1."""
    error = flip_map(subject)
    return {"flip": float(error[subject.truth.mask].mean())}


def flip_map(subject: Subject) -> np.ndarray:
    """The HDR-FLIP map, (h, w), with exposures given, since automatic ones can be infinite."""
    stops = float(np.log2(subject.truth.exposure))
    error, _, _ = flip_evaluator.evaluate(
        np.ascontiguousarray(np.clip(subject.truth.mean, 0, None), np.float32),
        np.ascontiguousarray(np.clip(subject.joined, 0, None), np.float32),
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
    return error[..., 0]
