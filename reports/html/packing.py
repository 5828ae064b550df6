"""Pixels as text that the page's own script unpacks (`packing.js`): small, and numbers still.

Radiance is kept as half floats, within 2.5e-4 of itself, after a power of 2 that brings the
brightest pixel to the end of their range: what is a thousand million times dimmer still has all
digits. Half floats of one sign are ordered as their bits are, so that neighbours differ little in
them: what is deflated is how far each pixel is off the mean of its left and its upper neighbour, of
G, R - G and B - G.
"""

import base64
import math
import zlib

import numpy as np

LARGEST = 65504.0  # that a half float holds
LEVEL = 6  # of deflation: 9 takes 3 times as long for 1 %


def packed_radiance(rgb: np.ndarray) -> tuple[str, float]:
    """Linear radiance (h, w, 3) as base64, and by what the script has to multiply it.

    NaN and Inf stay what they are.
    """
    finite = np.where(np.isfinite(rgb), np.abs(rgb), 0)
    largest = float(finite.max(initial=0))
    scale = 2.0 ** math.ceil(math.log2(largest / LARGEST)) if largest > 0 else 1.0
    codes = (np.asarray(rgb, np.float64) / scale).astype(np.float16).view(np.int16)
    red, green, blue = (codes[..., c] for c in range(3))
    planes = np.stack([green, red - green, blue - green])  # all in 16 bits: what leaves comes back
    left = np.pad(planes, ((0, 0), (0, 0), (1, 0)))[:, :, :-1].astype(np.int32)
    above = np.pad(planes, ((0, 0), (1, 0), (0, 0)))[:, :-1]
    off = planes - ((left + above) >> 1).astype(np.int16)
    zigzag = ((off << 1) ^ (off >> 15)).view(np.uint16)  # small whichever its sign
    high, low = (zigzag >> 8).astype(np.uint8), zigzag.astype(np.uint8)
    return _text(high.tobytes() + low.tobytes()), scale


def packed_places(places: np.ndarray) -> str:
    """Small whole numbers (h, w) uint8 as base64."""
    return _text(places.astype(np.uint8).tobytes())


def _text(data: bytes) -> str:
    return base64.b64encode(zlib.compress(data, LEVEL)).decode("ascii")
