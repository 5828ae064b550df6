"""The frames of one case, read from disk, and one object cut out of them."""

import math
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from reports.display import exposure_for
from reports.metrics.subject import Subject, TruthView, crop_of
from reports.results import CaseRecord, Row
from scenes.errors import InputError
from scenes.frame import Frame, load_frame


class PictureError(Exception):
    """A picture that cannot be shown, and why."""


def told(error: Exception) -> str:
    """What to say in place of a picture; anything unforeseen with its kind."""
    if isinstance(error, PictureError):
        return str(error)
    return f"it cannot be drawn ({type(error).__name__}: {error})"


@dataclass
class CaseFrames:
    """A case's frames by the names of its record; each is read once.

    Attributes:
        folder: what the record's paths are relative to.
        rows: the rows of this case.
    """

    record: CaseRecord
    folder: Path
    rows: list[Row]
    _read: dict[str, Frame] = field(default_factory=dict)
    _views: dict[tuple[str, str], TruthView] = field(default_factory=dict)

    def candidate(self, name: str) -> np.ndarray:
        """Linear radiance (h, w, 3) of a picture by its name.

        Raises:
            PictureError: there is no such picture.
        """
        if name not in self.record.candidates:
            known = (r.problem for r in self.rows if r.picture == name and r.problem)
            raise PictureError(next(known, f"the run recorded none of {name}"))
        return self._frame(self.record.candidates[name]).rgb

    def halves(self, truth: str) -> np.ndarray:
        """The means of two independent halves of a truth's batches, (2, h, w, 3)."""
        if truth not in self.record.truths:
            raise PictureError(f"there is no reference '{truth}' of this case")
        a, b = (self._frame(path).rgb for path in self.record.truths[truth])
        if a.shape != b.shape:
            raise PictureError(f"the halves of '{truth}' differ in size")
        return np.stack([a, b])

    def truth(self, truth: str) -> np.ndarray:
        """Linear radiance (h, w, 3), the mean of both halves."""
        return self.halves(truth).mean(axis=0)

    def mask(self, truth: str, name: str) -> np.ndarray:
        """The pixels (h, w) of an object in a truth."""
        self.halves(truth)
        ids = self._frame(self.record.truths[truth][0]).ids
        if ids is None:
            raise PictureError("the reference carries no mask of its objects")
        if name not in self.record.objects:
            raise PictureError(f"the case has no object '{name}'")
        return ids == 1 + self.record.objects.index(name)

    @cached_property
    def exposure(self) -> float:
        """One display scale for the whole case: the middle one of its objects.

        Where no candidate could be compared, that of all objects in a truth; 1 without a truth.
        """
        if known := [r.exposure for r in self.rows if 0 < r.exposure < math.inf]:
            return float(np.median(known))
        for name in self.record.truths:
            try:
                masks = [self.mask(name, of) for of in self.record.objects]
                return exposure_for(self.truth(name), np.any(masks, axis=0))
            except PictureError:
                continue
        return 1.0

    def exposure_of(self, row: Row) -> float:
        """The display scale of a row's object; the case's where the row has none."""
        return row.exposure if 0 < row.exposure < math.inf else self.exposure

    def subject(self, row: Row) -> tuple[Subject, tuple[slice, slice]]:
        """What the metrics saw of a row's object, and where in the picture that lies."""
        candidate = self.candidate(row.picture)
        mask, halves = self.mask(row.truth, row.object), self.halves(row.truth)
        if candidate.shape != halves.shape[1:]:
            raise PictureError("candidate and reference differ in size")
        if not mask.any():
            raise PictureError(row.problem or f"'{row.object}' covers no pixel")
        crop = crop_of(mask)
        if (row.truth, row.object) not in self._views:  # shared by techniques, with its moments
            exposure = self.exposure_of(row)
            corner = (crop[0].start, crop[1].start)
            view = TruthView(halves[:, *crop], mask[crop], exposure, corner)
            self._views[row.truth, row.object] = view
        return Subject(candidate[crop], self._views[row.truth, row.object]), crop

    def _frame(self, path: str) -> Frame:
        if path not in self._read:
            try:
                self._read[path] = load_frame(self.folder / path)
            except InputError as error:
                raise PictureError(f"{path}: {error.problem}") from error
        return self._read[path]
