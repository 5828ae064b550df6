"""All rows of a run in one table that can be filtered and sorted."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from reports.gate import worst_first
from reports.html.figures import METRICS, percent, seconds, similarity
from reports.html.matrix import label_of, row_id
from reports.results import Row

# What rows can be filtered by: the name in an address, the heading, and a row's own.
FILTERS: tuple[tuple[str, str, Callable[[Row], str]], ...] = (
    ("verdict", "Verdict", lambda r: r.verdict),
    ("material", "Material", lambda r: r.material),
    ("weight", "Weight", lambda r: f"{r.weight:g}"),
    ("technique", "Technique", lambda r: r.technique),
    ("truth", "Reference", lambda r: r.truth),
    ("case", "Case", lambda r: r.case),
)


@dataclass(frozen=True)
class Number:
    """A figure as shown, and as sorted; empty where there is none."""

    text: str
    value: str


@dataclass(frozen=True)
class Line:
    """A row: its values by the names in FILTERS, and its figures in the order of HEADINGS."""

    href: str
    label: str
    row: Row
    values: dict[str, str]
    numbers: list[Number]


@dataclass(frozen=True)
class Finder:
    """The table, worst row first, and what each filter can choose."""

    lines: list[Line]
    choices: list[tuple[str, str, list[str]]]
    headings: list[str]


# Sorted by distance from the truth where a sign would put the darkest first.
NUMBERS: tuple[tuple[str, Callable[[Row], float], Callable[[float], str], bool], ...] = (
    ("local energy", lambda r: r.energy_local, percent, False),
    ("total energy", lambda r: r.energy_error, lambda v: percent(v, signed=True), True),
    ("SSIM", lambda r: r.ssim, similarity, False),
    ("FLIP", lambda r: r.flip, lambda v: similarity(v, 3), False),
    ("margin", lambda r: margin_of(r), lambda v: percent(v, signed=True), False),
    ("frame", lambda r: r.frame_ms / 1e3, seconds, False),
)


def finder_of(rows: list[Row]) -> Finder:
    """The table of a run's rows."""
    lines = [
        Line(
            row_id(row),
            label_of(row, rows),
            row,
            {name: of(row) for name, _, of in FILTERS},
            [_number(of(row), show, size) for _, of, show, size in NUMBERS],
        )
        for row in worst_first(rows)
    ]
    choices = [
        (name, heading, list(dict.fromkeys(of(r) for r in rows))) for name, heading, of in FILTERS
    ]
    told = [(name, heading, own) for name, heading, own in choices if len(own) > 1]
    return Finder(lines, told, [name for name, *_ in NUMBERS])


def margin_of(row: Row) -> float:
    """The smallest margin to a budget, as a fraction of it; NaN where there is none."""
    known = [m for n, m in row.margins.items() if n in METRICS and not math.isnan(m)]
    return min(known, default=math.nan)


def _number(value: float, show: Callable[[float], str], size: bool) -> Number:
    sorted_by = abs(value) if size else value
    return Number(show(value), f"{sorted_by:.6g}" if math.isfinite(value) else "")
