"""What a texture unit reads: bilinear, clamped and trilinear look-ups."""

import numpy as np


def bilinear(texels: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """A texture (H, W, C) at (n, 2): columns wrap, rows clamp, texel centres at (i + .5) / size."""
    height, width = texels.shape[:2]
    x, y = uv[:, 0] * width - 0.5, np.clip(uv[:, 1] * height - 0.5, 0, height - 1)
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    right, across = (x - left)[:, None], (y - top)[:, None]
    low = np.minimum(top + 1, height - 1)
    one, two = (
        texels[row, left % width] * (1 - right) + texels[row, (left + 1) % width] * right
        for row in (top, low)
    )
    return one * (1 - across) + two * across


def clamped(texels: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """The same where columns clamp too, as in a table."""
    half = 0.5 / texels.shape[1]
    return bilinear(texels, np.stack([np.clip(uv[:, 0], half, 1 - half), uv[:, 1]], 1))


def trilinear(levels: list[np.ndarray], uv: np.ndarray, lod: np.ndarray | float) -> np.ndarray:
    """The same between levels, each at its own `lod`, (n,) or one for all."""
    lod = np.clip(np.broadcast_to(lod, len(uv)), 0, len(levels) - 1)
    low, each = np.floor(lod).astype(int), np.arange(len(uv))
    high, part = np.minimum(low + 1, len(levels) - 1), (lod - low)[:, None]
    looked = np.stack([bilinear(level, uv) for level in levels])
    return looked[low, each] * (1 - part) + looked[high, each] * part
