"""Pixels to PNG data URIs."""

import base64
import io
from collections.abc import Sequence

import numpy as np
from PIL import Image

from reports.display import display
from reports.html.colour import NOT_A_NUMBER, Scale


def picture(rgb: np.ndarray, exposure: float) -> str:
    """Linear radiance (h, w, 3) as people see it; pixels that are no numbers are magenta."""
    finite = np.isfinite(rgb).all(axis=2)
    shown = np.round(display(np.where(finite[..., None], rgb, 0), exposure) * 255).astype(np.uint8)
    shown[~finite] = NOT_A_NUMBER
    return _uri(Image.fromarray(shown))


def colour_map(values: np.ndarray, inside: np.ndarray, scale: Scale) -> str:
    """Values (h, w) on a colour scale; clear outside, magenta where a value inside is NaN."""
    return indexed(scale.places(values, inside), scale.palette)


def indexed(indices: np.ndarray, palette: Sequence[tuple[int, int, int]]) -> str:
    """Places (h, w) uint8 in a palette of sRGB colours, of which the first is clear."""
    image = Image.fromarray(indices.astype(np.uint8), mode=None).convert("P")
    image.putpalette([channel for colour in palette for channel in colour])
    return _uri(image, transparency=0)


def _uri(image: Image.Image, **options: int) -> str:
    data = io.BytesIO()
    image.save(data, "PNG", compress_level=6, **options)  # 9 takes 6 times as long for 2 %
    return "data:image/png;base64," + base64.b64encode(data.getvalue()).decode("ascii")
