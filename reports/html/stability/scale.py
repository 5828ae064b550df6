"""The colours of the atlas: one scale for each kind of figure, and what is over a limit unlike it.

Within its limit a cell is blue, over it orange, both darker the larger the figure. Where the limit
is promised a cell over it is striped, elsewhere dotted, and one that is no number is crossed out,
so that nothing is told by colour alone.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from reports.html.colour import ramp
from reports.html.numbers import departure, figure
from reports.html.png import indexed

CELL = 8  # px of a cell in the picture
STEPS = 33  # four for each power of ten
# ColorBrewer's Blues and Oranges (Brewer 2002), the latter without its darkest, for stripes.
WITHIN = ("#f0f6fc", "#c6dbef", "#6baed6", "#2171b5", "#08306b")
OVER = ("#fdd0a2", "#fdae6b", "#fd8d3c", "#f16913", "#d94801")
CLEAR, INK, WHITE = (255, 255, 255), (0, 0, 0), (255, 255, 255)
PALETTE = [
    CLEAR, *(tuple(c) for stops in (WITHIN, OVER) for c in ramp(stops, STEPS).tolist()), INK, WHITE,
]  # fmt: skip
MARK, LIGHT = len(PALETTE) - 2, len(PALETTE) - 1


@dataclass(frozen=True)
class AtlasScale:
    """Where a figure lies between the ends of a kind of figure, and what stands at these ends.

    Attributes:
        place: figures to places, 0 to 1 and beyond.
        ticks: places in percent and labels.
        told: a figure to some digits, as text.
        off: how far off a figure is: of what is to be 1 its departure, of a share what is over 1.
        decades: whether places are powers of ten, from 1e-8 to 1.
    """

    place: Callable[[np.ndarray], np.ndarray]
    ticks: tuple[tuple[float, str], ...]
    told: Callable[[float, int], str]
    off: Callable[[float], float] = lambda value: value
    decades: bool = True


def _logarithmic(values: np.ndarray) -> np.ndarray:
    return (np.log10(np.maximum(values, 1e-8)) + 8) / 8


ERRORS = AtlasScale(
    _logarithmic,
    ((0, "1e−8 or less"), (25, "1e−6"), (50, "1e−4"), (75, "1e−2"), (100, "1 or more")),
    told=figure,
)
DEPARTURES = AtlasScale(
    lambda values: _logarithmic(np.abs(values - 1)),
    ((0, "1 exactly"), (25, "±1e−6"), (50, "±1e−4"), (75, "±1e−2"), (100, "±1 or more")),
    told=departure,
    off=lambda value: abs(value - 1),
)
MOST = 1.25
SHARES = AtlasScale(
    lambda values: values / MOST,
    ((0, "0"), (40, "0.5"), (80, "1"), (100, f"{MOST} or more")),
    told=departure,
    off=lambda value: max(value - 1, 0.0),
    decades=False,
)
RATIOS = AtlasScale(SHARES.place, SHARES.ticks, told=figure, decades=False)


def scale_of(ranges: Iterable[tuple[float | None, float | None]]) -> AtlasScale:
    """The scale of figures by what any of them is allowed: from where, and to where.

    A range around 1 is about departures from 1, another one about shares of a whole. Without one
    they are shares of what is allowed where the limit is 1, and else errors.
    """
    for low, high in ranges:
        if low is not None and high is not None:
            return DEPARTURES if math.isclose(1 - low, high - 1, rel_tol=1e-6) else SHARES
        if high == 1:
            return RATIOS
    return ERRORS


def place(scale: AtlasScale, value: float) -> float:
    """Where a figure lies on a scale, in percent."""
    return round(100 * float(np.clip(scale.place(np.float64(value)), 0, 1)), 2)


def over(values: np.ndarray, at_least: float | None, limit: float | None) -> np.ndarray:
    """Which figures are beyond a limit."""
    low, high = (-np.inf if at_least is None else at_least), (np.inf if limit is None else limit)
    with np.errstate(invalid="ignore"):
        return (values < low) | (values > high)


def drawn(
    values: np.ndarray, tried: np.ndarray, beyond: np.ndarray, judged: np.ndarray, scale: AtlasScale
) -> str:
    """A slice (rows, columns) as a picture, its first row at the bottom; a data URI.

    Args:
        tried: where there is a figure; all else is left clear.
        beyond: which figures are over the limit.
        judged: where the limit is promised.
    """
    finite = np.isfinite(values)
    share = np.clip(scale.place(np.where(finite, values, 1)), 0, 1)
    colour = 1 + np.round(share * (STEPS - 1)).astype(np.uint8) + STEPS * beyond.astype(np.uint8)
    broken = tried & ~finite
    colour[broken] = MARK
    colour[~tried] = 0
    large = _enlarged(colour)
    y, x = np.indices(large.shape) % CELL
    striped, dotted = beyond & judged & ~broken, beyond & ~judged & ~broken
    large[_enlarged(striped) & ((x + y) % CELL < 2)] = MARK
    large[_enlarged(dotted) & (abs(2 * x + 1 - CELL) < 3) & (abs(2 * y + 1 - CELL) < 3)] = MARK
    large[_enlarged(broken) & ((x == y) | (x + y == CELL - 1))] = LIGHT
    return indexed(large[::-1], PALETTE)


def _enlarged(cells: np.ndarray) -> np.ndarray:
    return cells.repeat(CELL, axis=0).repeat(CELL, axis=1)
