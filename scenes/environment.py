"""Lat-long radiance maps, decoded, checked and sanitised once for both renderers."""

import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from scenes.errors import InputError
from scenes.files import checked_file

FORMATS = (".exr", ".hdr")
DECODERS = {".exr": "openexr", ".hdr": "hdr"}  # as OpenImageIO calls what must be inside
STARTS = {".exr": b"v/1\x01", ".hdr": b"#?"}
BRIGHTEST = 1e15  # sums of squared radiance over a map stay inside float32
FAINTEST = 1e-30  # less counts as 0: times a solid angle it would be a denormal, or lost
GREY = ("Y", "L", "LUMINANCE")
LARGEST = 16384  # texels a side that every OpenGL 4 driver takes
MOST_BLANK = 1 << 24  # pixels that a file may show without storing them
# TIFF's orientations that are mere flips: steps over rows and columns.
FLIPS = {1: (1, 1), 2: (1, -1), 3: (-1, -1), 4: (-1, 1)}


@dataclass(frozen=True, eq=False)
class RadianceMap:
    """Linear radiance by direction.

    Row 0 is the pole +z and the last row the pole -z (rows are aligned to the poles, columns to
    texel centres: Mitsuba's `envmap`). Column u in [0, 1) lies at azimuth atan2(x, y) = 2 pi u.

    Attributes:
        radiance: (H, W, 3) float32, linear sRGB, finite and not negative; H is at least 3.
        negatives: how many texel channels were below zero and set to zero.
    """

    radiance: np.ndarray
    negatives: int


@cache
def load_environment(path: Path) -> RadianceMap:
    """Decode an .exr or .hdr file; small negatives from lossy compression become zero.

    A chromaticities header is ignored: both sides take the numbers as linear sRGB.

    Raises:
        InputError: the file is missing, unreadable, smaller than 2x1, or holds NaN, Inf or what is
            brighter than BRIGHTEST.
    """
    if path.suffix.lower() not in FORMATS:
        raise InputError(path, "environment", "unknown format", "use .exr or .hdr")
    pixels = read_pixels(path, "environment")
    if pixels.shape[1] < 2:
        raise InputError(path, "environment", "is 1 texel wide", "give at least 2x1 texels")
    for what, bad in (
        ("NaN or Inf", ~np.isfinite(pixels)),
        (f"brighter than {BRIGHTEST:g}", pixels > BRIGHTEST),
    ):
        if bad.any():
            row, column = np.argwhere(bad.any(axis=2))[0]
            problem = f"{int(bad.sum())} values are {what}, first at row {row}, column {column}"
            raise InputError(path, "environment", problem, "repair or re-export the map")
    negatives = int((pixels < 0).sum())
    kept = np.where(pixels >= FAINTEST, pixels, np.float32(0))
    return RadianceMap(_three_rows(kept), negatives)


def _three_rows(radiance: np.ndarray) -> np.ndarray:
    """The same light in at least 3 rows: below that Mitsuba's `envmap` would resample it.

    Rows are aligned to the poles and bilinear in between, so the mean in the middle is exact.
    """
    if len(radiance) > 2:
        return radiance
    top, bottom = radiance[0], radiance[-1]
    return np.stack([top, top / 2 + bottom / 2, bottom])


def read_pixels(path: Path, field: str, size: tuple[int, int] | None = None) -> np.ndarray:
    """Read an image of one part and one set of R, G, B as (H, W, 3) float32; grey is spread.

    Args:
        size: the width and height that it must have; any if None.

    Raises:
        InputError: the file is missing, is not what its ending says, or cannot be decoded.
    """
    checked_file(path, "name an existing image file", field)
    try:
        return _read(path, field, size)
    except UnicodeDecodeError as error:
        problem = "is damaged (its header holds what is no text)"
        raise InputError(path, field, problem, "export it again") from error


def _read(path: Path, field: str, size: tuple[int, int] | None) -> np.ndarray:
    as_stored = oiio.ImageSpec()
    as_stored.attribute("oiio:UnassociatedAlpha", 1)  # colours are not multiplied by alpha
    image = oiio.ImageInput.open(str(path), as_stored)
    if image is None:
        oiio.geterror()  # told in our words: the library's are for programmers
        raise InputError(path, field, f"cannot be read ({_why(path)})", "export it again")
    try:
        spec = image.spec()
        _as_named(path, field, image.format_name(), str(spec.format))
        if image.seek_subimage(1, 0):
            raise InputError(path, field, "has more than one part", "export it as one part")
        image.seek_subimage(0, 0)
        _check_size(path, field, spec, size)
        orientation = spec.get_int_attribute("Orientation", 1)
        if orientation not in FLIPS:
            raise InputError(path, field, "is stored on its side", "export it again, row 0 on top")
        rgb = _rgb(path, field, spec.channelnames)
        first, beyond = min(rgb), max(rgb) + 1
        # Memory that is not written yet takes none: a header alone does not fill it.
        pixels = image.read_image(0, 0, first, beyond, oiio.FLOAT)
        if pixels is None:
            raise InputError(path, field, "is damaged or cut short", "export it again")
    finally:
        image.close()
    pixels = np.asarray(pixels, np.float32).reshape(spec.height, spec.width, beyond - first)
    pixels = _whole(pixels[..., [place - first for place in rgb]], spec)
    return np.ascontiguousarray(pixels[:: FLIPS[orientation][0], :: FLIPS[orientation][1]])


def _why(path: Path) -> str:
    """What keeps a file from being opened as a picture, by its first bytes."""
    with path.open("rb") as file:
        start = file.read(4)
    ending = path.suffix.lower()
    if not start:
        return "it is empty"
    if not start.startswith(STARTS.get(ending, b"")):
        return f"it is no {ending} file"
    return "its header is damaged, or of a kind that is not known here"


def _check_size(
    path: Path, field: str, spec: oiio.ImageSpec, wanted: tuple[int, int] | None
) -> None:
    """Refuse a picture of the wrong size, or one too large to decode, by its header."""
    whole, stored = (spec.full_width, spec.full_height), (spec.width, spec.height)
    if max(*whole, *stored) > LARGEST:
        problem = f"has {whole[0]}x{whole[1]} pixels"
        if max(stored) > LARGEST:
            problem = f"stores {stored[0]}x{stored[1]} pixels"
        raise InputError(path, field, problem, f"give at most {LARGEST} a side")
    if wanted and whole != wanted:
        problem = f"is {whole[0]}x{whole[1]} pixels, not {wanted[0]}x{wanted[1]}"
        raise InputError(path, field, problem, "draw it at the size of the case")
    if math.prod(whole) - math.prod(stored) > MOST_BLANK:
        problem = f"stores {stored[0]}x{stored[1]} of its {whole[0]}x{whole[1]} pixels"
        raise InputError(path, field, problem, "export all of them")


def _as_named(path: Path, field: str, found: str, depth: str) -> None:
    """Refuse a file that is not what its ending says, such as a renamed PNG."""
    if found == DECODERS.get(path.suffix.lower(), found):
        return
    whole = {"uint8": ", 8 bit", "uint16": ", 16 bit"}.get(depth, "")
    problem = f"is {'an' if found[0] in 'aeio' else 'a'} {found}{whole}"
    right = [ending for ending, name in DECODERS.items() if name == found]
    remedy = f"name it {right[0]}" if right else "convert it to .exr or .hdr"
    raise InputError(path, field, problem, remedy)


def _rgb(path: Path, field: str, channels: tuple[str, ...]) -> list[int]:
    """The places of R, G and B: under bare names, else in the one layer that has them."""
    if len(channels) == 1 and channels[0].rsplit(".", 1)[-1].upper() in GREY:
        return [0, 0, 0]
    layers: dict[str, dict[str, int]] = {}
    for place, name in enumerate(channels):
        layer, _, channel = name.rpartition(".")
        layers.setdefault(layer, {}).setdefault(channel.upper(), place)
    full = {n: c for n, c in layers.items() if {"R", "G", "B"} <= set(c)}
    if len(full) > 1 and "" not in full:
        problem = f"has R, G, B in several layers ({', '.join(full)})"
        raise InputError(path, field, problem, "export it with one of them")
    if not full:
        named = ", ".join(channels)
        raise InputError(path, field, f"has channels {named}, not R, G and B", "export it as RGB")
    chosen = full.get("") or next(iter(full.values()))
    return [chosen[c] for c in "RGB"]


def _whole(pixels: np.ndarray, spec: oiio.ImageSpec) -> np.ndarray:
    """The picture's display window: what an EXR stores beyond it is cut, what it lacks is 0."""
    left, top = spec.x - spec.full_x, spec.y - spec.full_y
    shape = (spec.full_height, spec.full_width)
    if (left, top, *pixels.shape[:2]) == (0, 0, *shape):
        return pixels
    whole = np.zeros((*shape, pixels.shape[2]), np.float32)
    rows, columns = np.arange(pixels.shape[0]) + top, np.arange(pixels.shape[1]) + left
    inside_y, inside_x = (rows >= 0) & (rows < shape[0]), (columns >= 0) & (columns < shape[1])
    whole[np.ix_(rows[inside_y], columns[inside_x])] = pixels[np.ix_(inside_y, inside_x)]
    return whole
