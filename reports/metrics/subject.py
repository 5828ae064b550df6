"""What a metric is given: one object, cut out of a candidate and of a truth's batches."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import ndimage

from reports.noise import grouped

GROUPS = 8  # of batches, for the noise of every figure but energy, where every batch is cheap
MARGIN = 8  # pixels around the object; SSIM's window reaches 5


@dataclass(frozen=True, eq=False)
class TruthView:
    """One object in a truth.

    Attributes:
        batches: (n, h, w, 3) float32 linear radiance.
        mask: (h, w) bool, the pixels of the object.
        exposure: display scale, from the `global` truth.
        corner: row and column of the picture that (0, 0) is cut out at.
    """

    batches: np.ndarray
    mask: np.ndarray
    exposure: float
    corner: tuple[int, int] = (0, 0)

    @cached_property
    def mean(self) -> np.ndarray:
        """The truth, (h, w, 3)."""
        return self.batches.mean(axis=0)

    @cached_property
    def groups(self) -> np.ndarray:
        """Means of at most 8 groups of batches of equal size, (g, h, w, 3)."""
        return grouped(self.batches, GROUPS)

    @cached_property
    def core(self) -> np.ndarray:
        """The mask eroded by one pixel, (h, w): where SSIM is averaged."""
        return ndimage.binary_erosion(self.mask)

    @cached_property
    def shown(self) -> dict:
        """The truth after display, by exposure; filled by metrics.ssim, shared by candidates."""
        return {}


@dataclass(frozen=True, eq=False)
class Subject:
    """A candidate's picture of the object, (h, w, 3) linear, beside the truth's."""

    candidate: np.ndarray
    truth: TruthView

    @cached_property
    def joined(self) -> np.ndarray:
        """The candidate on the object, the truth outside, so that nothing leaks into windows."""
        return np.where(self.truth.mask[..., None], self.candidate, self.truth.mean)


def crop_of(mask: np.ndarray) -> tuple[slice, slice]:
    """Rows and columns that hold a mask (H, W) with a margin."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return (
        slice(max(rows[0] - MARGIN, 0), rows[-1] + 1 + MARGIN),
        slice(max(columns[0] - MARGIN, 0), columns[-1] + 1 + MARGIN),
    )
