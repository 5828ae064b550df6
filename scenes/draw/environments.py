"""Environments drawn at random: skies and rooms, of the means and contrasts of real ones."""

from collections.abc import Callable

import numpy as np

from scenes.draw.dice import Rng, log_within, one_of, rounded
from scenes.draw.rooms import lamps, painted, studio, windows
from scenes.draw.skies import clear_sky, clouds, dusk, forest
from scenes.draw.sphere import Canvas

KINDS: dict[str, Callable[[Rng, Canvas], np.ndarray]] = {
    "clear_sky": clear_sky,
    "clouds": clouds,
    "dusk": dusk,
    "forest": forest,
    "studio": studio,
    "lamps": lamps,
    "windows": windows,
    "painted": painted,
}
HEIGHTS = (256, 384, 512)
BITS = 12  # significant in a texel; a photograph has no more
FEWEST_ROWS = 8


def draw_environment(kind: str, rng: Rng, detail: float = 1.0) -> np.ndarray:
    """Radiance (H, 2 H, 3) float32, laid out as `scenes.environment.RadianceMap` says.

    Args:
        kind: one of KINDS.
        detail: the share of its rows to paint; 1 for all.
    """
    height = max(round(one_of(rng, *HEIGHTS) * detail), FEWEST_ROWS)
    mean = log_within(rng, 0.25, 1.6)
    canvas = Canvas(2 * height, height)
    radiance = KINDS[kind](rng, canvas)
    return rounded(radiance * mean / canvas.mean(radiance).mean(), BITS)
