"""How much of the occlusion and of the interreflection a candidate lacks, by least squares."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reports.ladder.candidate import Candidate
from reports.ladder.rungs import NAMES, RUNGS
from reports.ladder.sums import Pictures
from reports.noise import Estimate, jackknife

PARTS = 16  # of an object, by rows of blocks, for the spread of what a candidate lacks


def lacking(blocks: Pictures, pixels: np.ndarray, candidate: Candidate) -> dict[str, Estimate]:
    """How much of the occlusion and of the interreflection the candidate lacks, as fractions.

    By least squares over the blocks, each over the block's light. A candidate with a switch for one
    of them draws R2 - R1 of T2 - T1 and R3 - R2 of T3 - T2, a slope each. Else R1 - T1 is fitted by
    T2 - T1, T3 - T2 and T1 (a gain, so that a picture too bright is not taken for one without
    shadows). Products are taken between different batches, so that noise does not flatten the
    slopes.

    What else is wrong with a candidate may look alike, and a share need not be the same everywhere.
    So the error holds what batches move the slopes by, what parts of the object do, and what other
    weights of the blocks do.
    """
    least = min(len(blocks.cells[t]) for t in RUNGS[:3])  # another's truths may differ in number
    one, two, three = (blocks.cells[t][:least] for t in RUNGS[:3])
    drawn = [np.broadcast_to(blocks.cells[candidate.name[t]], one.shape) for t in RUNGS[:3]]
    if candidate.switched(*RUNGS[:2]) or candidate.switched(*RUNGS[1:3]):
        fits = [
            np.stack([truth, own], axis=1)
            for truth, own in ((two - one, drawn[1] - drawn[0]), (three - two, drawn[2] - drawn[1]))
        ]
    else:
        fits = [np.stack([two - one, three - two, one, drawn[0] - one], axis=1)]
    lit = (three.mean(axis=0) > 0) & (one.mean(axis=0) > 0)
    pixels, first, light = pixels[lit], one[:, lit].mean(axis=0), three[:, lit].mean(axis=0)
    weights = [np.sqrt(pixels) / light, np.sqrt(pixels) / first]
    weights += [1 / np.sqrt(light), 1 / np.sqrt(pixels)]
    slopes = [slope for vectors in fits for slope in _slopes(vectors[..., lit], weights)]
    return {
        name: Estimate(1 - slope.value, slope.se, slope.dof)
        for name, slope in zip(NAMES[1:3], slopes, strict=False)
    }


def _slopes(vectors: np.ndarray, weights: Sequence[np.ndarray]) -> list[Estimate]:
    """The slopes of a fit by the first of some weights of the cells, with all that moves them."""
    batches, cells = np.arange(len(vectors)), np.arange(vectors.shape[2])
    fit = _Fit(vectors, weights[0])
    by_batch = np.stack([fit(batches[batches != k], cells) for k in batches])
    parts = np.array_split(cells, PARTS)
    by_part = np.stack([fit(batches, np.setdiff1d(cells, part)) for part in parts])
    others = [_Fit(vectors, w)(batches, cells) for w in weights]
    error = np.sqrt(jackknife(by_batch) + jackknife(by_part) + np.var(others, axis=0, ddof=1))
    dof = len(weights) - 1
    return [
        Estimate(float(value), float(se), dof)
        for value, se in zip(fit(batches, cells), error, strict=True)
    ]


@dataclass(frozen=True)
class _Fit:
    """The slopes of the last of some pictures on the others, from some batches and cells.

    Attributes:
        vectors: (n, m + 1, c), pictures as light in cells, of n batches.
        weights: (c,) by which cells are scaled.
    """

    vectors: np.ndarray
    weights: np.ndarray

    def __call__(self, batches: np.ndarray, cells: np.ndarray) -> np.ndarray:
        """(m,), NaN where the others do not tell."""
        known = self.vectors.shape[1] - 1
        kept = self.vectors[np.ix_(batches, range(known + 1), cells)] * self.weights[cells]
        total = kept.sum(axis=0)
        products = total @ total.T - np.einsum("kac,kbc->ab", kept, kept)
        try:
            return np.linalg.solve(products[:known, :known], products[:known, known])
        except np.linalg.LinAlgError:
            return np.full(known, np.nan)
