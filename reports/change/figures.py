"""How far figures move from one picture to another, with intervals over an object's blocks.

Both pictures are held against one reference, so that its noise is in both and cancels. What is left
is how evenly a change lies over the object: blocks are drawn with replacement (the block bootstrap,
Künsch 1989), the same for both pictures. The same code draws the same picture, whose change is 0.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from reports.metrics import energy
from reports.metrics.flip import flip_maps
from reports.metrics.ssim import ssim_map
from reports.metrics.subject import Subject

BLOCK = 32  # pixels: FLIP's and SSIM's windows reach 10 and 5
REPLICATES = 2000
FEWEST = 4  # blocks that an interval takes
# The least change that counts: about a tenth of what a viewer could see.
TOLERANCES = {"energy_local": 1e-3, "energy_error": 1e-3, "ssim": 1e-3, "flip": 1e-3}


@dataclass(frozen=True)
class Moved:
    """A change of a figure, new less old, with its 95 % interval; NaN where blocks are few."""

    figure: str
    change: float
    low: float
    high: float


def moved(old: Subject, new: Subject) -> list[Moved]:
    """How far each figure of TOLERANCES moved.

    Args:
        old, new: two pictures of one object, beside the same truth.
    """
    mask = old.truth.mask
    if np.array_equal(old.candidate[mask], new.candidate[mask]):
        return [Moved(name, 0.0, 0.0, 0.0) for name in TOLERANCES]
    return [_moved(name, statistic) for name, statistic in _statistics(old, new)]


Statistic = tuple[Callable[[np.ndarray], np.ndarray], np.ndarray]


def _statistics(old: Subject, new: Subject) -> Iterator[tuple[str, Statistic]]:
    """Of each figure its change by how often blocks are drawn, (r, b) -> (r,), and the blocks."""
    truth = old.truth
    blocks = _blocks(truth.mask, truth.corner)
    yield "energy_local", _local(old, new)
    yield "energy_error", (_total(old, new, blocks), np.unique(blocks[truth.mask]))
    core, own = truth.core, np.unique(blocks[truth.core])
    maps = [ssim_map(s, truth.exposure).mean(axis=2) for s in (new, old)]
    yield "ssim", (_mean(maps[0] - maps[1], blocks, core), own)
    after, before = flip_maps([new, old])
    yield "flip", (_mean(after - before, blocks, truth.mask), np.unique(blocks[truth.mask]))


def _moved(name: str, statistic: Statistic) -> Moved:
    change, blocks = statistic
    count = len(blocks)
    found = float(change(np.ones((1, count)))[0])
    if count < FEWEST and found != 0:
        return Moved(name, found, np.nan, np.nan)
    drawn = np.random.default_rng(1).multinomial(count, np.full(count, 1 / count), REPLICATES)
    low, high = np.quantile(change(drawn.astype(float)), [0.025, 0.975])
    return Moved(name, found, float(min(low, found)), float(max(high, found)))


def _blocks(mask: np.ndarray, corner: tuple[int, int]) -> np.ndarray:
    """The number of the block that each pixel lies in, (h, w), on the picture's grid."""
    rows, columns = ((np.arange(n) + at) // BLOCK for n, at in zip(mask.shape, corner, strict=True))
    return (rows - rows[0])[:, None] * (columns[-1] - columns[0] + 1) + columns - columns[0]


def _sums(values: np.ndarray, blocks: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Values (h, w) summed over the blocks that hold pixels of the mask, (b,)."""
    _, numbers = np.unique(blocks[mask], return_inverse=True)
    return np.bincount(numbers, values[mask].astype(float))


def _mean(apart: np.ndarray, blocks: np.ndarray, mask: np.ndarray) -> Callable:
    sums = _sums(apart, blocks, mask)
    pixels = _sums(np.ones_like(apart), blocks, mask)
    return lambda drawn: drawn @ sums / (drawn @ pixels)


def _total(old: Subject, new: Subject, blocks: np.ndarray) -> Callable:
    """Change of the size of the energy error."""
    mask = old.truth.mask
    before, after, truth = (
        _sums(light.mean(axis=2), blocks, mask)
        for light in (old.candidate, new.candidate, old.truth.mean)
    )

    def change(drawn: np.ndarray) -> np.ndarray:
        light = np.maximum(drawn @ truth, 1e-30)
        return abs(drawn @ after / light - 1) - abs(drawn @ before / light - 1)

    return change


def _local(old: Subject, new: Subject) -> Statistic:
    """Change of local energy error; the reference's noise falls out of differences of squares."""
    before, after, weights, numbers = energy.paired_squares(old, new, BLOCK)
    owners, group = np.unique(numbers, return_inverse=True)

    def grouped(values: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(group, v, len(owners)) for v in values.T], axis=1)

    before, after = grouped(before), grouped(after)
    pixels = np.bincount(group, weights, len(owners))

    def change(drawn: np.ndarray) -> np.ndarray:
        share = (drawn @ pixels)[:, None]
        squares = [np.maximum((drawn @ s / share).max(axis=1), 0) for s in (before, after)]
        return np.sqrt(squares[1]) - np.sqrt(squares[0])

    return change, owners
