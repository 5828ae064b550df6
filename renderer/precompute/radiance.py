"""The environment as a texture with mips that average over solid angle, not over texels."""

from pathlib import Path

import moderngl
import numpy as np
from scipy.sparse import csr_array, diags_array

from renderer.context import context
from scenes.environment import load_environment


def make(path: Path) -> moderngl.Texture:
    """A float32 RGBA texture with full mips; columns wrap, rows clamp."""
    return as_texture(load_environment(path).radiance)


def as_texture(radiance: np.ndarray) -> moderngl.Texture:
    """The same of a map (H, W, 3) at hand."""
    levels = pyramid(radiance)
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
        rows = overlap(below.shape[0], max(below.shape[0] // 2, 1)) @ diags_array(weights)
        weights = rows.sum(axis=1)
        halved = averaged(rows, below)
        columns = overlap(below.shape[1], max(below.shape[1] // 2, 1))
        levels.append(averaged(columns, halved.swapaxes(0, 1)).swapaxes(0, 1).astype(np.float32))
    return levels


def averaged(shares: csr_array, cells: np.ndarray) -> np.ndarray:
    """Means (m, ...) of cells (n, ...), weighted by shares (m, n)."""
    weights = np.maximum(shares.sum(axis=1), 1e-30)
    sums = shares @ cells.reshape(len(cells), -1)
    return (sums / weights[:, None]).reshape(-1, *cells.shape[1:])


def overlap(fine: int, coarse: int) -> csr_array:
    """How much of each fine cell lies in each coarse cell, (coarse, fine), in fine cells."""
    edges = np.union1d(np.arange(fine + 1), np.linspace(0, fine, coarse + 1))
    middle = (edges[1:] + edges[:-1]) / 2  # of the pieces between edges of either kind
    places = (middle * coarse / fine).astype(int), middle.astype(int)
    return csr_array((np.diff(edges), places), shape=(coarse, fine))
