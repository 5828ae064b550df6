"""Lat-long radiance maps, decoded, checked and sanitised once for both renderers."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from scenes.errors import InputError

FORMATS = (".exr", ".hdr")


@dataclass(frozen=True, eq=False)
class RadianceMap:
    """Linear radiance by direction.

    Row 0 is the pole +z and the last row the pole -z (rows are aligned to the poles, columns to
    texel centres: Mitsuba's `envmap`). Column u in [0, 1) lies at azimuth atan2(x, y) = 2 pi u.

    Attributes:
        radiance: (H, W, 3) float32, linear sRGB, finite and not negative.
        negatives: how many texel channels were below zero and set to zero.
    """

    radiance: np.ndarray
    negatives: int


@cache
def load_environment(path: Path) -> RadianceMap:
    """Decode an .exr or .hdr file; small negatives from lossy compression become zero.

    A chromaticities header is ignored: both sides take the numbers as linear sRGB.

    Raises:
        InputError: the file is missing, unreadable, smaller than 2x1, or holds NaN or Inf.
    """
    if path.suffix.lower() not in FORMATS:
        raise InputError(path, "environment", "unknown format", "use .exr or .hdr")
    pixels = read_pixels(path, "environment")
    if pixels.shape[1] < 2:
        raise InputError(path, "environment", "is 1 texel wide", "give at least 2x1 texels")
    if not (finite := np.isfinite(pixels)).all():
        row, column = np.argwhere(~finite.all(axis=2))[0]
        problem = (
            f"{int((~finite).sum())} values are NaN or Inf, first at row {row}, column {column}"
        )
        raise InputError(path, "environment", problem, "repair or re-export the map")
    negatives = int((pixels < 0).sum())
    return RadianceMap(np.maximum(pixels, 0), negatives)


def read_pixels(path: Path, field: str) -> np.ndarray:
    """Read the first three channels of an image as (H, W, 3) float32, grey spread over RGB.

    Raises:
        InputError: the file is missing or cannot be decoded.
    """
    if not path.is_file():
        raise InputError(path, field, "no such file", "name an existing image file")
    image = oiio.ImageInput.open(str(path))
    if image is None:
        reason = oiio.geterror().strip().splitlines() or ["unknown format"]
        raise InputError(path, field, f"cannot be read ({reason[-1]})", "export it again")
    try:
        spec = image.spec()
        names = [n.rsplit(".", 1)[-1].upper() for n in spec.channelnames]
        pixels = image.read_image(oiio.FLOAT)
        if pixels is None:
            raise InputError(path, field, "is damaged or cut short", "export it again")
    finally:
        image.close()
    pixels = np.asarray(pixels, np.float32).reshape(spec.height, spec.width, spec.nchannels)
    if {"R", "G", "B"} <= set(names):
        return np.ascontiguousarray(pixels[..., [names.index(c) for c in "RGB"]])
    if spec.nchannels == 1:
        return np.repeat(pixels, 3, axis=2)
    raise InputError(path, field, f"has channels {names}, not R, G and B", "export it as RGB")
