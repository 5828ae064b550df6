"""Pictures that stand in the page itself: close-ups of the worst row, and maps of causes."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from reports.frames import CaseFrames, PictureError, told
from reports.html.colour import SIGNED
from reports.html.png import colour_map, picture
from reports.ladder import NAMES, RUNGS
from reports.metrics.energy import block_errors
from reports.metrics.subject import Subject
from reports.results import Ladder, Row

CLOSE_UP = 2.1  # width over height, so that three stand in a row on the first screen


@dataclass(frozen=True)
class Picture:
    """One image of a case, or why there is none.

    Attributes:
        kind: a key of page.KINDS.
        techniques, truths: those with which it is shown; empty for all of them.
        uri: a PNG as data URI, empty where there is a problem.
        size: width and height in pixels.
        name: of a candidate's picture, as in its rows.
    """

    kind: str
    techniques: tuple[str, ...]
    truths: tuple[str, ...]
    uri: str
    size: tuple[int, int]
    problem: str = ""
    name: str = ""

    def shown(self, technique: str, truth: str) -> bool:
        """Whether it is shown where these are chosen."""
        here = not self.techniques or technique in self.techniques
        return here and (not self.truths or truth in self.truths)

    @property
    def of(self) -> str:
        """What it is of, in words; empty where it is the same for all."""
        own = [self.name] if self.name else [*self.techniques, *self.truths]
        return ", ".join(own)


def pixel_errors(subject: Subject) -> np.ndarray:
    """Signed relative error per pixel (h, w), mean of R, G and B, with the noise left in.

    Divided by the truth, or by 1 % of the object's mean where the truth is darker than that.
    """
    truth, mask = subject.truth.mean.mean(axis=2), subject.truth.mask
    floor = max(0.01 * float(truth[mask].mean()), 1e-30)
    return (subject.candidate.mean(axis=2) - truth) / np.maximum(truth, floor)


def close_ups(frames: CaseFrames, row: Row) -> list[Picture]:
    """Candidate, truth and signed error around one row's object, at the object's exposure."""
    window, exposure, reason = None, 1.0, ""
    try:
        mask = frames.mask(row.truth, row.object)
        window, exposure = _window(mask), frames.exposure_of(row)
        reason = "" if window else row.problem or f"'{row.object}' covers no pixel"
    except Exception as error:  # whatever it is, the rest of the page is still worth having
        reason = told(error)

    def shown(kind: str) -> str:
        if reason or window is None:
            raise PictureError(reason)
        if kind == "signed":
            return _drawn(frames, [row], lambda subject, _: pixel_errors(subject), window)
        whole = frames.candidate(row.picture) if kind == "candidate" else frames.truth(row.truth)
        return picture(whole[window], exposure)

    size = _size(window) if window else (0, 0)
    names = {"candidate": row.picture, "truth": "", "signed": ""}
    return [
        _made(kind, (row.technique,), (row.truth,), size, partial(shown, kind), name)
        for kind, name in names.items()
    ]


def cause_maps(frames: CaseFrames, ladders: list[Ladder]) -> list[Picture]:
    """A map of each whole cause, one for all techniques that have no switch for it."""
    size = frames.record.width, frames.record.height
    climbed = {(f.object, f.technique, f.truth) for f in ladders}
    switched = {(f.technique, name) for f in ladders for name in f.switched}
    rows: dict[str, list[Row]] = {}
    for row in frames.rows:
        if (row.object, row.technique, row.truth) in climbed:
            rows.setdefault(row.technique, []).append(row)
    if not rows:
        return []
    last = next(iter(rows.values()))[0].truth
    wanted = [(NAMES[0], (technique,)) for technique in rows]
    for name in NAMES[1 : 1 + RUNGS.index(last)]:
        if alike := tuple(t for t in rows if (t, name) not in switched):
            wanted.append((name, alike if len(alike) < len(rows) else ()))
        wanted += [(name, (t,)) for t in rows if t not in alike]
    return [
        _made(name, own, (), size, partial(_cause_map, frames, rows[next(iter(own or rows))], name))
        for name, own in wanted
    ]


def _cause_map(frames: CaseFrames, rows: list[Row], name: str) -> str:
    """What one cause adds to the light of each block, over the last truth's.

    Args:
        rows: of one technique, against the last truth.
    """
    place, technique = NAMES.index(name), rows[0].technique
    drawn = {r.truth: r.picture for r in frames.rows if r.technique == technique}

    def alone(subject: Subject, crop: tuple[slice, slice]) -> np.ndarray:
        """The error that is left if all but this cause were right."""
        pairs = [(1, RUNGS[place]), (-1, RUNGS[place - 1])] if place else [(1, RUNGS[0])]
        added = -sum(sign * frames.truth(truth)[crop] for sign, truth in pairs)
        if len({drawn[truth] for _, truth in pairs}) == len(pairs):  # else it stays where it is
            added = added + sum(sign * frames.candidate(drawn[t])[crop] for sign, t in pairs)
        return block_errors(Subject(subject.truth.mean + added, subject.truth))

    return _drawn(frames, rows, alone)


def _drawn(
    frames: CaseFrames,
    rows: list[Row],
    compute: Callable[[Subject, tuple[slice, slice]], np.ndarray],
    window: tuple[slice, slice] = np.s_[:, :],
) -> str:
    """A signed map of values (h, w) that are computed object by object, each in its crop.

    An object that cannot be shown is left out, unless there is no other.
    """
    shape = frames.mask(rows[0].truth, rows[0].object).shape
    values, inside = np.full(shape, np.nan, np.float32), np.zeros(shape, bool)
    problems = []
    for row in rows:
        try:
            subject, crop = frames.subject(row)
            mask = subject.truth.mask
            values[crop][mask] = compute(subject, crop)[mask]
            inside[crop][mask] = True
        except Exception as error:  # the other objects still have something to show
            problems.append(told(error))
    if len(problems) == len(rows):
        raise PictureError(problems[0])
    return colour_map(values[window], inside[window], SIGNED)


def _made(
    kind: str,
    techniques: tuple[str, ...],
    truths: tuple[str, ...],
    size: tuple[int, int],
    make: Callable[[], str],
    name: str = "",
) -> Picture:
    """The picture, or its absence with the reason."""
    uri = problem = ""
    try:
        with np.errstate(all="ignore"):  # NaN and Inf of a candidate are counted in its row
            uri = make()
    except Exception as error:  # one bad picture must not cost the whole page
        problem = told(error)
    return Picture(kind, techniques, truths, uri, size, problem, name)


def _window(mask: np.ndarray) -> tuple[slice, slice] | None:
    """A window of CLOSE_UP's shape around a mask (H, W), or as much of it as the picture has.

    None where the mask is empty.
    """
    if not mask.any():
        return None
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    height = max(1.15 * (np.ptp(rows) + 1), 1.15 * (np.ptp(columns) + 1) / CLOSE_UP)
    spans = []
    for length, middle, total in zip(
        (height, height * CLOSE_UP),
        ((rows[0] + rows[-1] + 1) / 2, (columns[0] + columns[-1] + 1) / 2),
        mask.shape,
        strict=True,
    ):
        length = min(round(length), total)
        start = min(max(round(middle - length / 2), 0), total - length)
        spans.append(slice(start, start + length))
    return spans[0], spans[1]


def _size(window: tuple[slice, slice]) -> tuple[int, int]:
    return window[1].stop - window[1].start, window[0].stop - window[0].start
