"""Pictures that make a material vary over a mesh, decoded and checked once for both renderers."""

from functools import cache
from pathlib import Path

import numpy as np

from scenes.environment import read_pixels
from scenes.errors import InputError

FORMATS = (".png", ".exr")
STEEPEST = 100.0  # tangent of the angle by which a normal map may turn the normal


@cache
def load_texture(path: Path, name: str) -> np.ndarray:
    """A map's picture as (H, W, k) float32, row 0 at v = 0, the lower edge.

    An `albedo` is linear, k = 3: from a PNG by the sRGB curve (IEC 61966-2-1), from an EXR as it
    is. Of `roughness`, `metallic` and `weight` the red channel counts, linear in either, k = 1. A
    `normal` map holds (n + 1) / 2, n.y up in the picture, linear in either; it is returned as the
    slopes (n.x / n.z, n.y / n.z), k = 2, because what is interpolated and averaged are slopes
    (Olano and Baker 2010).

    Raises:
        InputError: the file is missing or no picture, or holds NaN or what lies outside of [0, 1],
            or a normal that points into the surface.
    """
    if path.suffix.lower() not in FORMATS:
        raise InputError(path, name, "unknown format", f"use {' or '.join(FORMATS)}")
    pixels = read_pixels(path, name)[::-1]
    if (bad := ~((pixels >= 0) & (pixels <= 1))).any():
        row, column = np.argwhere(bad.any(axis=2))[0]
        problem = f"{int(bad.sum())} values lie outside of [0, 1]"
        at = f"first at row {len(pixels) - 1 - row}, column {column}"
        raise InputError(path, name, f"{problem} (or are NaN), {at}", "scale or repair the picture")
    if name == "albedo":
        return np.ascontiguousarray(_linear(pixels) if path.suffix.lower() == ".png" else pixels)
    if name == "normal":
        return _slopes(path, pixels)
    return np.ascontiguousarray(pixels[..., :1])


def _linear(encoded: np.ndarray) -> np.ndarray:
    """The sRGB curve, decoded."""
    toe, curve = encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4
    return np.float32(np.where(encoded <= 0.04045, toe, curve))


def _slopes(path: Path, pixels: np.ndarray) -> np.ndarray:
    normals = 2 * pixels - 1
    if (bad := normals[..., 2] <= 0).any():
        row, column = np.argwhere(bad)[0]
        at = f"first at row {len(pixels) - 1 - row}, column {column}"
        problem = f"{int(bad.sum())} normals point into the surface, {at}"
        raise InputError(path, "normal", problem, "give a tangent-space map, its blue above 0.5")
    slopes = normals[..., :2] / normals[..., 2:]
    return np.ascontiguousarray(np.clip(slopes, -STEEPEST, STEEPEST), np.float32)
