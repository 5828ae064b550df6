"""The table of a case's points: what each costs, and its errors."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import get_args

from reports.html.figures import NONE, digits, percent, seconds, size
from reports.html.speed.scatter import QUANTITIES, error_of, row_id
from reports.results import Figured
from reports.speed.points import Change, Point


@dataclass(frozen=True)
class Cell:
    """A figure as text, with its interval, and as the number that its column is sorted by."""

    text: str
    spread: str
    number: float | None


@dataclass(frozen=True)
class Line:
    """One point."""

    id: str
    point: Point
    cells: list[Cell]


@dataclass(frozen=True)
class PointTable:
    """The points of one case: groups of columns with their headings, and the lines."""

    groups: list[tuple[str, list[str]]]
    lines: list[Line]


def point_table(points: Sequence[Point], objects: Sequence[str]) -> PointTable:
    """All points of a case, with the columns for which any of them has a figure."""
    sample = min((p.frame.median for p in points if _one_path(p)), default=math.nan)
    costs = {
        "Frame": {
            "median": lambda p: _time(p.frame.median, p.frame.low, p.frame.high),
            "a second": lambda p: _plain(_over(1, p.frame.median), digits),
            "GPU": lambda p: _time(p.gpu.median, p.gpu.low, p.gpu.high) if p.gpu else _time(),
            "× 1 sample": lambda p: _plain(_over(p.frame.median, sample), digits),
        },
        "Made once": {
            "compilation": lambda p: _time(p.compilation),
            "precomputation": lambda p: _time(p.precomputation),
            "preparation": lambda p: _time(p.preparation),
        },
        "Next frame after a change of": {c: _after(c) for c in get_args(Change)},
        "Memory": {
            "peak": lambda p: _plain(p.memory, size),
            "held": lambda p: _plain(p.held, size),
        },
    }
    columns = costs | {name: _errors(name) for name in objects}
    groups: list[tuple[str, list[str]]] = []
    kept: list[Callable[[Point], Cell]] = []
    for group, found in columns.items():
        shown = {
            h: make for h, make in found.items() if any(make(p).number is not None for p in points)
        }
        if shown:
            groups.append((group, list(shown)))
            kept += shown.values()
    lines = [Line(row_id(p), p, [make(p) for make in kept]) for p in points]
    return PointTable(groups, lines)


def _one_path(point: Point) -> bool:
    return point.family == "path traced" and point.samples == 1


def _over(a: float, b: float) -> float:
    return a / b if b else math.nan


def _after(change: Change) -> Callable[[Point], Cell]:
    return lambda p: _time(p.after.get(change, math.nan))


def _errors(object_name: str) -> dict[str, Callable[[Point], Cell]]:
    """The errors of one object."""

    def figure(field: str, show: Callable[[float], str]) -> Callable[[Point], Cell]:
        def cell(point: Point) -> Cell:
            error = error_of(point, object_name)
            return _figured(getattr(error, field), show) if error else _plain(math.nan, show)

        return cell

    return {
        **{q.name: figure(q.field, q.show) for q in QUANTITIES},
        "Total energy error": figure("energy_error", lambda v: percent(v, signed=True)),
    }


def _time(value: float = math.nan, low: float = math.nan, high: float = math.nan) -> Cell:
    return _figured(Figured(value=value, low=low, high=high), seconds)


def _plain(value: float, show: Callable[[float], str]) -> Cell:
    return _figured(Figured(value=value, low=math.nan, high=math.nan), show)


def _figured(figure: Figured, show: Callable[[float], str]) -> Cell:
    if not math.isfinite(figure.value):
        return Cell(NONE, "", None)
    spread = ""
    if math.isfinite(figure.low) and math.isfinite(figure.high):
        spread = f"{show(figure.low)} to {show(figure.high)}"
    return Cell(show(figure.value), spread, figure.value)
