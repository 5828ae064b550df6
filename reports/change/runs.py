"""Two runs of a suite, row by row: what got better, what got worse, and what cannot be told."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from reports.change.figures import TOLERANCES, Moved, moved
from reports.change.ranking import NEW_ROW, RISES
from reports.frames import CaseFrames, PictureError
from reports.metrics.subject import Subject
from reports.results import Change, Changes, Incomparable, Keyed, Results, Row

MOVED_REFERENCE = 5.0  # standard errors of its light, from which on a reference is another's


def changes_between(
    old: Results, old_path: Path, new: Results, new_path: Path, judged: bool = False
) -> Changes:
    """What changed from an old run to a new one.

    Rows are paired by case, object, technique and truth. Where both runs' pictures and the new
    one's reference can be read, both pictures are held against that; else the runs' own figures
    are compared, each with its own noise.

    Args:
        old_path, new_path: of their results.json, beside which their frames lie.
        judged: whether worse rows are to fail the new run.
    """
    before = {r.key: r for r in old.rows}
    made: list[Change] = []
    unpaired: list[Incomparable] = []
    for case in dict.fromkeys(r.case for r in new.rows):
        rows = [r for r in new.rows if r.case == case]
        known = [before.pop(r.key) for r in rows if r.key in before]
        pictures = _Pictures((old, old_path.parent, known), (new, new_path.parent, rows))
        known = {r.key: r for r in known}
        for row in rows:
            found = _changed(known.get(row.key), row, pictures)
            if isinstance(found, str):
                unpaired.append(Incomparable(**_about(row), reason=found))
            else:
                made += found
    for row in before.values():
        reason = "the new run does not have it"
        unpaired.append(Incomparable(**_about(row), reason=reason, lost=True))
    return Changes(
        path=str(old_path),
        suite=old.suite,
        created=old.created,
        judged=judged,
        changes=made,
        incomparable=unpaired,
    )


class _Pictures:
    """The pictures of one case in both runs, as far as they can be read."""

    def __init__(self, *runs: tuple[Results, Path, list[Row]]) -> None:
        (case,) = {r.case for *_, rows in runs for r in rows}
        self.frames = []
        for results, folder, rows in runs:
            record = next((c for c in results.cases if c.id == case), None)
            self.frames.append(CaseFrames(record, folder, rows) if record else None)

    def pair(self, before: Row, after: Row) -> tuple[Subject, Subject]:
        """Both pictures of an object beside the new run's reference.

        Raises:
            PictureError: they cannot be had, or show another scene.
        """
        old, new = self.frames
        if old is None or new is None:
            raise PictureError("a run did not record the case")
        subject, crop = new.subject(after)
        mask = new.mask(after.truth, after.object)
        picture = old.candidate(before.picture)
        if picture.shape[:2] != mask.shape:
            raise PictureError("the pictures differ in size")
        self._same_reference(before, after, mask)
        return Subject(picture[crop], subject.truth), subject

    def _same_reference(self, before: Row, after: Row, mask: np.ndarray) -> None:
        """Refuse a reference that shows other light than the old run's did."""
        old, new = self.frames
        try:
            theirs, shape = old.halves(before.truth), old.mask(before.truth, before.object)
        except PictureError:
            return  # the old pictures alone will do
        ours = new.halves(after.truth)
        if theirs.shape != ours.shape or not np.array_equal(shape, mask):
            raise OtherSceneError("the reference shows the object elsewhere: the scene has changed")
        if np.array_equal(theirs, ours):
            return
        light = [half[mask].mean(dtype=float) for half in (*theirs, *ours)]
        noise = math.hypot(*(_noise(halves[:, mask]) for halves in (theirs, ours)))
        if abs(sum(light[:2]) - sum(light[2:])) / 2 > MOVED_REFERENCE * noise:
            raise OtherSceneError("the reference itself has changed: the scene, or its light")


class OtherSceneError(PictureError):
    """Two runs that do not show the same."""


def _noise(halves: np.ndarray) -> float:
    """Standard error of the mean light of two halves (2, p, 3)."""
    apart = (halves[0] - halves[1]).astype(float)
    return float(np.sqrt((apart.mean(axis=1) ** 2).sum()) / 2 / len(apart))


def _changed(before: Row | None, after: Row, pictures: _Pictures) -> list[Change] | str:
    """The changes of a row, or why there are none."""
    if before is None:
        return NEW_ROW
    if before.problem or after.problem:
        return f"could not be measured: {after.problem or before.problem}"
    try:
        old, new = pictures.pair(before, after)
        mask = new.truth.mask
        if np.array_equal(old.candidate[mask], new.candidate[mask]):
            same = ((name, getattr(after, name)) for name in TOLERANCES)
            found = [Moved(name, value, value, 0.0, 0.0, 0.0) for name, value in same]
        else:
            found = moved(old, new)
    except OtherSceneError as error:
        return str(error)
    except PictureError as error:
        return list(_from_rows(before, after, str(error)))
    return [_judged(after, change, paired=True) for change in found]


def _from_rows(before: Row, after: Row, reason: str) -> Iterator[Change]:
    """Changes of the figures that both runs wrote down, each with its own noise."""
    for name in TOLERANCES:
        old, new = getattr(before, name), getattr(after, name)
        field = "energy_ci95" if name == "energy_error" else f"{name}_ci95"
        bounds = [getattr(r, field) for r in (before, after)]
        change = abs(new) - abs(old)
        # The same figures with the same noise are of the same reference.
        same = (old, bounds[0]) == (new, bounds[1])
        reach = 0.0 if same else math.hypot(*((high - low) / 2 for low, high in bounds))
        if math.isfinite(change):
            moved = Moved(name, old, new, change, change - reach, change + reach)
            yield _judged(after, moved, paired=False, reason=reason)


def _judged(after: Row, moved: Moved, paired: bool, reason: str = "") -> Change:
    """A change and its verdict: a paired one is exact, another has the noise of two runs."""
    tolerance, sign = TOLERANCES[moved.figure], RISES.get(moved.figure, 1)
    ends = (moved.change, moved.change) if paired else (moved.low, moved.high)
    low, high = sorted(sign * end for end in ends)
    if math.isnan(low) or math.isnan(high):
        verdict = "unclear"
    elif low > tolerance:
        verdict = "worse"
    elif high < -tolerance:
        verdict = "better"
    else:
        verdict = "unchanged" if -tolerance <= low and high <= tolerance else "unclear"
    return Change(
        **_about(after),
        figure=moved.figure,
        old=moved.old,
        new=moved.new,
        change=moved.change,
        low=moved.low,
        high=moved.high,
        tolerance=tolerance,
        paired=paired,
        reason=reason,
        verdict=verdict,
    )


def _about(row: Row) -> dict[str, str]:
    """The fields that say which row a record is about."""
    return dict(zip(Keyed.model_fields, row.key, strict=True))
