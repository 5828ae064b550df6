"""A map of the atlas: small pictures by weight, what their cells hold, and the worst point."""

import math
from dataclasses import dataclass

import numpy as np

from reports.html.colour import ramp
from reports.html.figures import slug
from reports.html.stability.numbers import figure, input_value, name
from reports.html.stability.scale import ERRORS, OVER, SHARES, WITHIN, drawn, over, place
from reports.stability.results import Axis, Map, Worst

TICKS = 4  # on an axis, at most
SHARE_DIGITS, ERROR_DIGITS = 4, 2


@dataclass(frozen=True)
class Mark:
    """A point of a slice, in percent from its left and its top."""

    x: float
    y: float
    kind: str


@dataclass(frozen=True)
class Slice:
    """One small picture. `cells` are its figures as text, row by row from the bottom."""

    label: str
    uri: str
    marks: list[Mark]
    cells: str


@dataclass(frozen=True)
class WorstView:
    """A worst point: its figure, its inputs, and the id and text of the command."""

    value: str
    inputs: str
    id: str
    command: str


@dataclass(frozen=True)
class MapView:
    """One map."""

    id: str
    map: Map
    what: str
    worst: str
    limit: str
    beyond: str
    over: bool
    place: float
    limits: list[float]
    legend: str
    ticks: tuple[tuple[float, str], ...]
    legend_limits: list[tuple[float, str]]
    slices: list[Slice]
    columns: list[tuple[float, str]]
    rows: list[tuple[float, str]]
    box: tuple[float, float, float, float] | None
    axes: dict[str, list[str]]
    points: list[tuple[str, WorstView]]


def map_view(found: Map) -> MapView:
    """Everything that the page shows of a map."""
    scale = SHARES if found.at_least is not None else ERRORS
    id = slug("map", found.function, found.invariant, *([found.masking] if found.masking else []))
    values = np.array(
        [[[math.nan if v is None else v for v in row] for row in rows] for rows in found.values]
    )
    tried = np.array([[[v is not None for v in row] for row in rows] for rows in found.values])
    inside = _judged(found)
    beyond = over(values, found.at_least, found.limit)
    digits = SHARE_DIGITS if found.at_least is not None else ERROR_DIGITS
    limits = [v for v in (found.at_least, found.limit) if v is not None]
    slices, rows, columns = found.axes
    points = [("Worst", _point(found.worst, f"{id}--worst", digits))]
    if found.beyond:
        told = ("Worst outside of it", _point(found.beyond, f"{id}--beyond", digits))
        points.append(told)
    marks = [_mark(values, tried & inside, found.worst.value, "worst")]
    if found.beyond:
        marks.append(_mark(values, tried & ~inside, found.beyond.value, "beyond"))
    return MapView(
        id=id,
        map=found,
        what=found.invariant + (f", masking {found.masking}" if found.masking else ""),
        worst=figure(found.worst.value, digits),
        limit=limit_text(found.at_least, found.limit),
        beyond=figure(found.beyond.value, digits) if found.beyond else "",
        over=not found.passed,
        place=place(scale, found.worst.value),
        limits=[place(scale, v) for v in limits],
        legend=_legend([place(scale, v) for v in limits], found.at_least is not None),
        ticks=scale.ticks,
        legend_limits=[(place(scale, v), figure(v, digits)) for v in limits],
        slices=[
            Slice(
                label=f"{name(slices.name)} {input_value(slices.values[k])}",
                uri=drawn(values[k], tried[k], beyond[k], inside[k], scale),
                marks=[m for at, m in filter(None, marks) if at == k],
                cells=_cells(values[k], tried[k], digits),
            )
            for k in range(len(slices.values))
        ],
        columns=_ticks(columns),
        rows=[(100 - at, text) for at, text in _ticks(rows)],
        box=_box(inside) if found.limit is not None and not inside.all() else None,
        axes={
            "names": [name(a.name) for a in (columns, rows, slices)],
            "columns": [input_value(v) for v in columns.values],
            "rows": [input_value(v) for v in rows.values],
            "slices": [input_value(v) for v in slices.values],
        },
        points=points,
    )


def limit_text(at_least: float | None, limit: float | None) -> str:
    """What is allowed; empty where nothing is."""
    if limit is None:
        return ""
    if at_least is None:
        return f"≤ {figure(limit)}" if limit else "0"
    return f"{figure(at_least, SHARE_DIGITS)} to {figure(limit, SHARE_DIGITS)}"


def _judged(found: Map) -> np.ndarray:
    """Where the limit is promised, slices x rows x columns."""
    inside = np.ones([len(a.values) for a in found.axes], bool)
    for at, axis in enumerate(found.axes):
        low, high = found.judged.get(axis.name, (-math.inf, math.inf))
        kept = [low - abs(low) * 1e-6 <= v <= high + abs(high) * 1e-6 for v in axis.values]
        inside &= np.array(kept).reshape([-1 if k == at else 1 for k in range(3)])
    return inside


def _mark(
    values: np.ndarray, among: np.ndarray, value: float, kind: str
) -> tuple[int, Mark] | None:
    """The slice and place of the first cell that holds a figure."""
    same = among & (np.isnan(values) if math.isnan(value) else values == value)
    if not same.any():
        return None
    k, row, column = np.argwhere(same)[0]
    _, rows, columns = values.shape
    x, y = 100 * (column + 0.5) / columns, 100 - 100 * (row + 0.5) / rows
    return int(k), Mark(round(x, 2), round(y, 2), kind)


def _point(worst: Worst, id: str, digits: int) -> WorstView:
    inputs = ", ".join(f"{name(n)} {v}" for n, v in worst.inputs.items())
    return WorstView(figure(worst.value, digits), inputs, id, worst.command)


def _cells(values: np.ndarray, tried: np.ndarray, digits: int) -> str:
    """Figures parted by blanks; a dot where nothing was tried."""
    return " ".join(
        figure(float(v), digits).replace("\u202f", "") if t else "."
        for v, t in zip(values.ravel(), tried.ravel(), strict=True)
    )


def _ticks(axis: Axis) -> list[tuple[float, str]]:
    """Places in percent and labels of a few cells: the ends, and round ones between."""
    count = len(axis.values)
    step = max(math.ceil((count - 1) / (TICKS - 1)), 1)
    if axis.log and count > TICKS:  # whole powers of ten, as far apart as needed
        tens = [i for i, v in enumerate(axis.values) if _power_of_ten(v)]
        stride = max(math.ceil((len(tens) - 1) / (TICKS - 1)), 1)
        chosen = tens[::-1][::stride]
    else:
        chosen = list(range(0, count, step))
    return [(round(100 * (i + 0.5) / count, 2), input_value(axis.values[i])) for i in chosen]


def _power_of_ten(value: float) -> bool:
    return value > 0 and abs(math.log10(value) - round(math.log10(value))) < 1e-6


def _box(inside: np.ndarray) -> tuple[float, float, float, float]:
    """Left, top, width and height in percent of what is judged, which is a rectangle."""
    rows, columns = np.flatnonzero(inside.any((0, 2))), np.flatnonzero(inside.any((0, 1)))
    _, height, width = inside.shape
    left, right = columns[0] / width, (columns[-1] + 1) / width
    bottom, top = rows[0] / height, (rows[-1] + 1) / height
    return tuple(round(100 * v, 2) for v in (left, 1 - top, right - left, top - bottom))


def _legend(limits: list[float], both: bool) -> str:
    """The bar of a scale as a CSS image: blue where a figure is allowed, orange where not."""
    low = limits[0] if both else 0.0
    high = limits[-1] if limits else 100.0
    parts = [(0.0, low, OVER), (low, high, WITHIN), (high, 100.0, OVER)]
    stops = []
    for start, end, colours in parts:
        if end > start:
            inner = [p for p in np.linspace(0, 100, len(colours)) if start < p < end]
            stops += [f"{_at(colours, p)} {p:g}%" for p in (start, *inner, end)]
    return f"linear-gradient(to right, {', '.join(stops)})"


def _at(colours: tuple[str, ...], percent: float) -> str:
    """The colour at a place of a ramp."""
    return f"rgb({' '.join(map(str, ramp(colours, 101)[round(percent)]))})"
