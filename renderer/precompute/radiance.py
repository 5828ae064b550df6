"""The environment as a texture with mips that average over solid angle, not over texels."""

from pathlib import Path

import moderngl
import numpy as np

from renderer.context import context
from scenes.environment import load_environment


def make(path: Path) -> moderngl.Texture:
    """A float32 RGBA texture with full mips; columns wrap, rows clamp."""
    levels = pyramid(load_environment(path).radiance)
    height, width = levels[0].shape[:2]
    texture = context().texture((width, height), 4, dtype="f4")
    texture.build_mipmaps()  # allocates the levels that are overwritten here
    for level, pixels in enumerate(levels):
        alpha = np.ones((*pixels.shape[:2], 1), np.float32)
        texture.write(np.concatenate([pixels, alpha], axis=2).tobytes(), level=level)
    texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    texture.repeat_x, texture.repeat_y = True, False
    return texture


def pyramid(radiance: np.ndarray) -> list[np.ndarray]:
    """Mips of a lat-long map (H, W, 3), each (H >> l, W >> l, 3) float32 and at least 1x1.

    A texel of each level is the mean over its solid angle of the level below, odd sizes
    included, so that every level holds the same power.
    """
    height = radiance.shape[0]
    # Rows are aligned to the poles: row r spans half a row spacing to either side.
    edges = np.clip((np.arange(height + 1) - 0.5) / max(height - 1, 1), 0, 1)
    weights = -np.diff(np.cos(np.pi * edges))
    levels = [np.asarray(radiance, np.float32)]
    while max(levels[-1].shape[:2]) > 1:
        below = levels[-1]
        rows = _overlap(below.shape[0], max(below.shape[0] // 2, 1)) * weights
        columns = _overlap(below.shape[1], max(below.shape[1] // 2, 1))
        weights = rows.sum(axis=1)
        rows /= np.maximum(weights, 1e-30)[:, None]
        columns /= columns.sum(axis=1, keepdims=True)
        levels.append(np.einsum("rh,hwc->rwc", rows, below, optimize=True))
        levels[-1] = np.einsum("cw,rwk->rck", columns, levels[-1], optimize=True).astype(np.float32)
    return levels


def _overlap(fine: int, coarse: int) -> np.ndarray:
    """How much of each fine cell lies in each coarse cell, (coarse, fine), in fine cells."""
    fine_edges = np.arange(fine + 1)
    coarse_edges = np.linspace(0, fine, coarse + 1)
    low = np.maximum(coarse_edges[:-1, None], fine_edges[None, :-1])
    high = np.minimum(coarse_edges[1:, None], fine_edges[None, 1:])
    return np.maximum(high - low, 0.0)
