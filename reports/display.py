"""The one display transform: exposure, clip, sRGB. Only SSIM, FLIP and people see it."""

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # linear sRGB to Y, IEC 61966-2-1
MIDDLE_GREY = 0.18
# Half of 8-bit sRGB's first step, after exposure: less light than any picture shows.
FAINTEST = 0.5 / 255 / 12.92


def display(rgb: np.ndarray, exposure: float) -> np.ndarray:
    """Linear radiance (..., 3) to display values in [0, 1]: scale, clip, sRGB curve."""
    clipped = np.clip(np.asarray(rgb, np.float32) * np.float32(exposure), 0, 1)
    return np.where(
        clipped <= 0.0031308,
        clipped * 12.92,
        1.055 * np.maximum(clipped, 1e-6) ** (1 / 2.4) - 0.055,
    ).astype(np.float32)


def exposure_for(truth: np.ndarray, mask: np.ndarray) -> float:
    """The scale that puts the median luminance of the truth (H, W, 3) on the mask at 0.18.

    1 where the object is black.
    """
    middle = float(np.median(truth[mask] @ LUMINANCE)) if mask.any() else 0.0
    return MIDDLE_GREY / middle if middle > 1e-12 else 1.0
