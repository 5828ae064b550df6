"""How far figures move from one picture to another, with intervals over an object's blocks.

Both pictures are held against one reference, so that its noise is in both and cancels, and a change
is exact: the same code draws the same picture, whose change is 0. The interval says how evenly it
lies over the object: blocks are drawn with replacement (the block bootstrap, Künsch 1989), the same
of both pictures.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from reports.metrics import energy
from reports.metrics.flip import flip_maps
from reports.metrics.ssim import ssim_map
from reports.metrics.subject import Subject

BLOCK = 32  # pixels: FLIP's and SSIM's windows reach 10 and 5
REPLICATES = 2000
FEWEST = 4  # blocks that such an interval takes
# The least change that counts: about a tenth of what a viewer could see.
TOLERANCES = {"energy_local": 1e-3, "energy_error": 1e-3, "ssim": 1e-3, "flip": 1e-3}


@dataclass(frozen=True)
class Moved:
    """A figure of two pictures, and the change of its size with a 95 % interval over blocks.

    The interval is NaN where blocks are few.
    """

    figure: str
    old: float
    new: float
    change: float
    low: float
    high: float


Values = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class _Statistic:
    """A figure of both pictures by how often blocks are drawn: (r, b) to (r,) each."""

    name: str
    values: Values
    blocks: int

    def moved(self) -> Moved:
        old, new = (float(v[0]) for v in self.values(np.ones((1, self.blocks))))
        change = abs(new) - abs(old)
        if self.blocks < FEWEST:
            return Moved(self.name, old, new, change, np.nan, np.nan)
        share = np.full(self.blocks, 1 / self.blocks)
        drawn = np.random.default_rng(1).multinomial(self.blocks, share, REPLICATES)
        before, after = self.values(drawn.astype(float))
        low, high = np.quantile(np.abs(after) - np.abs(before), [0.025, 0.975])
        return Moved(self.name, old, new, change, float(low), float(high))


def moved(old: Subject, new: Subject) -> list[Moved]:
    """How far each figure of TOLERANCES moved; no SSIM of an object without an interior.

    Args:
        old, new: two pictures of one object, beside the same truth.
    """
    return [statistic.moved() for statistic in _statistics(old, new)]


def _statistics(old: Subject, new: Subject) -> Iterator[_Statistic]:
    truth, mask = old.truth, old.truth.mask
    blocks = energy.block_labels(mask.shape, truth.corner, BLOCK)
    count = len(np.unique(blocks[mask]))
    yield _local(old, new)
    yield _Statistic("energy_error", _total(old, new, blocks), count)
    if truth.core.any():
        maps = [ssim_map(s, truth.exposure).mean(axis=2) for s in (old, new)]
        core = len(np.unique(blocks[truth.core]))
        yield _Statistic("ssim", _means(maps, blocks, truth.core), core)
    yield _Statistic("flip", _means(flip_maps([old, new]), blocks, mask), count)


def _sums(values: np.ndarray, blocks: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Values (h, w) summed over the blocks that hold pixels of the mask, (b,)."""
    _, numbers = np.unique(blocks[mask], return_inverse=True)
    return np.bincount(numbers, values[mask].astype(float))


def _means(maps: Sequence[np.ndarray], blocks: np.ndarray, mask: np.ndarray) -> Values:
    before, after = (_sums(values, blocks, mask) for values in maps)
    pixels = _sums(np.ones_like(maps[0]), blocks, mask)
    return lambda drawn: (drawn @ before / (drawn @ pixels), drawn @ after / (drawn @ pixels))


def _total(old: Subject, new: Subject, blocks: np.ndarray) -> Values:
    mask = old.truth.mask
    before, after, truth = (
        _sums(light.mean(axis=2), blocks, mask)
        for light in (old.candidate, new.candidate, old.truth.mean)
    )

    def values(drawn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        light = np.maximum(drawn @ truth, 1e-30)
        return drawn @ before / light - 1, drawn @ after / light - 1

    return values


def _local(old: Subject, new: Subject) -> _Statistic:
    """The reference's noise is taken out of the old squares, and falls out of the change."""
    before, after, weights, numbers = energy.paired_squares(old, new, BLOCK)
    owners, group = np.unique(numbers, return_inverse=True)

    def grouped(values: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(group, v, len(owners)) for v in values.T], axis=1)

    squares = grouped(before), grouped(after)
    pixels = np.bincount(group, weights, len(owners))

    def values(drawn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        share = (drawn @ pixels)[:, None]
        return tuple(np.sqrt(np.maximum((drawn @ s / share).max(axis=1), 0)) for s in squares)

    return _Statistic("energy_local", values, len(owners))
