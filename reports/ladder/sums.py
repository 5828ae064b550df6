"""Signed sums of pictures, on the whole object and in blocks, and how sure they are."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reports.ladder.candidate import Candidate
from reports.ladder.rungs import RUNGS, Terms
from reports.metrics.energy import block_weights, worst_channel
from reports.noise import Estimate, combined, jackknife, pairs, pairs_without_each
from scenes.frame import Frame


@dataclass(frozen=True)
class Pictures:
    """Pictures of an object as light in cells, by name.

    Attributes:
        cells: (n, c): n batches of a truth, or 1 for a candidate; c cells.
        source: the reference that a picture's batches belong to, so that what shares its paths is
            subtracted path by path; empty for a candidate, which has no noise here.
    """

    cells: dict[str, np.ndarray]
    source: dict[str, str]

    def total(self, terms: Terms, half: int | None = None) -> tuple[np.ndarray, np.ndarray]:
        """A signed sum of pictures, (c,), and its variance.

        Args:
            half: 0 or 1 for the even or the odd batches, None for all.
        """
        chosen = slice(half, None, None if half is None else 2)
        value = variance = np.zeros(next(iter(self.cells.values())).shape[1])
        for source in dict.fromkeys(self.source[name] for _, name in terms):
            own = [(sign, name) for sign, name in terms if self.source[name] == source]
            if not source:
                value = value + sum(sign * self.cells[name][0] for sign, name in own)
                continue
            batches = sum(sign * self.cells[name][chosen] for sign, name in own)
            value = value + batches.mean(axis=0)
            variance = variance + batches.var(axis=0, ddof=1) / len(batches)
        return value, variance

    def least(self) -> int:
        """The fewest batches of any truth."""
        return min(len(c) for n, c in self.cells.items() if self.source[n])


def pictures_of(candidate: Candidate, truths: dict[str, list[Frame]], cells) -> Pictures:
    """Everything that steps are made of, as light in cells."""
    made = {name: cells(rgb)[None] for name, rgb in candidate.pictures().items()}
    source = dict.fromkeys(made, "")
    for name, batches in truths.items():
        ours = "diffuse" in batches[0].layers  # else another's: paths and lobes are not told
        # The three truths of one model share their paths.
        shared = "model" if ours and name in RUNGS[:3] else name
        made[name] = np.stack([cells(b.rgb) for b in batches])
        source[name] = shared
        if ours:
            made[f"{name}.diffuse"] = np.stack([cells(b.layers["diffuse"]) for b in batches])
            source[f"{name}.diffuse"] = shared
    return Pictures(made, source)


class Energy:
    """Errors of the light on the whole object, over the last truth's; cells are pixels."""

    def __init__(self, pictures: Pictures, last: str) -> None:
        self.pictures = pictures
        self.dof = pictures.least() // 2 - 1
        light, variance = pictures.total([(1, last)])
        self.light = float(light.sum())
        self.relative = float(np.sqrt(variance.sum()) / self.light) if self.light > 0 else math.nan

    def of(self, terms: Terms, half: int) -> Estimate:
        """A signed sum of pictures, as a fraction of the truth's light."""
        if not self.light > 0:
            return Estimate(math.nan, math.nan)
        cells, variance = self.pictures.total(terms, half)
        value, (se, dof) = float(cells.sum()) / self.light, combined(variance, self.dof)
        return Estimate(value, se / self.light, dof).plus(value * self.relative)

    def gap(self, steps: Sequence[Terms], total: Terms, other: int) -> Estimate:
        """What the steps of both halves, summed, are off from the total of the half `other`."""
        sides = [[*own] for own in steps]
        sides[other] += [(-sign, name) for sign, name in total]
        cells, variances = zip(
            *(self.pictures.total(s, half) for half, s in enumerate(sides)), strict=True
        )
        se, dof = combined(np.concatenate(variances), self.dof)
        return Estimate(float(np.sum(cells)) / self.light, se / self.light, dof)


class Local:
    """Errors in blocks, as signed shares of local energy; cells are blocks of one channel.

    With e the total error of a block over its truth, local energy is the root L of the weighted
    mean of e², in the same channel and by the same weights as the row's `energy_local`, but of a
    half of the batches. A cause with error s in the blocks has the share mean(s e) / L: shares are
    signed, and those of causes that sum to e sum to L. s and e come from different batches.
    """

    def __init__(self, blocks: Pictures, pixels: np.ndarray, whole: Terms, other: int) -> None:
        self.blocks, self.whole, self.other = blocks, whole, other
        own, last = (name for _, name in whole)
        self.dof = blocks.least() // 2 - 1
        self.error, self.noise = zip(*(blocks.total(self.whole, h) for h in (0, 1)), strict=True)
        candidate, batches = (blocks.cells[n].reshape(-1, pixels.size // 3, 3) for n in (own, last))
        channel = worst_channel(pixels[::3], candidate[0], batches)
        weights = block_weights(pixels[::3], batches.mean(axis=0))
        self.weights = np.where(np.arange(3) == channel, weights, 0).ravel()
        errors = blocks.cells[own] - blocks.cells[last][other::2]
        products = self.weights * errors[:, None] * errors
        cells = pairs(products)
        self.square = float(cells.sum())
        self.root = math.sqrt(self.square) if self.square > 0 else math.nan
        # Where noise hides local energy there are no shares, but the sum can still be held to it.
        self.scale = self.root if self.square > 0 else math.sqrt(float(np.abs(cells).sum())) or 1.0
        variance = (
            jackknife(pairs_without_each(products))
            if len(errors) > 2
            else np.full(cells.shape, np.nan)
        )
        se, dof = combined(variance, len(errors) - 1)
        self.total = Estimate(self.root, se / (2 * self.root), dof)

    def share(self, terms: Terms, half: int) -> Estimate:
        """A cause's signed share."""
        (own, noise), error = self.blocks.total(terms, half), self.error[1 - half]
        value = float(np.sum(self.weights * own * error)) / self.root
        variance = self.weights**2 * (own**2 * self.noise[1 - half] + error**2 * noise)
        se, dof = combined(variance, self.dof)
        return Estimate(value, se / self.root, dof).plus(value * self.total.se / self.root)

    def gap(self, steps: Sequence[Terms]) -> Estimate:
        """What the shares of both halves' steps, summed, are off from the total.

        The gap is sum(s0 e1 + s1 e0) - sum(e²), so the noise of a half's batches enters as they
        are weighted in its derivative.
        """
        own = [self.blocks.total(terms, half)[0] for half, terms in enumerate(steps)]
        value, variances = -self.square, []
        for half, terms in enumerate(steps):
            error = self.error[1 - half]
            value += float(np.sum(self.weights * own[half] * error))
            slope = own[1 - half] - (2 * self.error[half] if half == self.other else 0)
            moved = [(sign * error, n) for sign, n in terms]
            moved += [(sign * slope, n) for sign, n in self.whole]
            variances.append(self.weights**2 * self.blocks.total(moved, half)[1])
        se, dof = combined(np.concatenate(variances), self.dof)
        return Estimate(value / self.scale, se / self.scale, dof)
