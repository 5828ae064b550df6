"""What each technique gains and costs, over all that the techniques of a run drew alike."""

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

import numpy as np

from reports.html.figures import NONE, digits, percent, seconds, similarity
from reports.results import Row

FULLEST = ("global", "direct", "unoccluded")  # of the case's own model


@dataclass(frozen=True)
class Gain:
    """A technique's line: medians over objects, the worst in brackets, and times.

    Attributes:
        times: how long its frame takes, in frames of the first technique, case by case.
    """

    technique: str
    ssim: str
    worst_ssim: str
    local: str
    worst_local: str
    frame: str
    times: str
    precomputation: str


@dataclass(frozen=True)
class Gains:
    """The table: against the fullest truth of the run, of so many objects."""

    truth: str
    objects: int
    lines: list[Gain]


def gains_of(rows: list[Row]) -> Gains | None:
    """The table, if several techniques drew something in common against the fullest truth."""
    if not rows:
        return None
    told = {r.truth for r in rows}
    truth = next((t for t in FULLEST if t in told), rows[0].truth)
    drawn: dict[str, dict[tuple[str, str], Row]] = {}
    for row in rows:
        if row.truth == truth:
            drawn.setdefault(row.technique, {})[row.case, row.object] = row
    alike = set.intersection(*(set(of) for of in drawn.values()))
    if len(drawn) < 2 or not alike:
        return None
    places = sorted(alike)
    first = next(iter(drawn.values()))
    lines = [
        _line(name, [of[p] for p in places], [first[p] for p in places])
        for name, of in drawn.items()
    ]
    return Gains(truth, len(places), lines)


def _line(technique: str, rows: list[Row], first: list[Row]) -> Gain:
    cases = {r.case: (r, other) for r, other in zip(rows, first, strict=True)}.values()
    return Gain(
        technique,
        _shown(similarity, median, [r.ssim for r in rows]),
        _shown(similarity, min, [r.ssim for r in rows]),
        _shown(percent, median, [r.energy_local for r in rows]),
        _shown(percent, max, [r.energy_local for r in rows]),
        _shown(seconds, median, [r.frame_ms / 1e3 for r, _ in cases]),
        _shown(digits, median, [r.frame_ms / other.frame_ms for r, other in cases]),
        _shown(seconds, median, [r.precomputation_ms / 1e3 for r, _ in cases]),
    )


def _shown(
    show: Callable[[float], str], of: Callable[[list[float]], float], values: list[float]
) -> str:
    known = [v for v in values if np.isfinite(v)]
    return show(of(known)) if known else NONE
