"""A map of the atlas: small pictures by weight, what their cells hold, and the worst point."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from reports.html.colour import ramp
from reports.html.figures import slug
from reports.html.numbers import figure, input_value, name
from reports.html.stability.scale import (
    ERRORS,
    OVER,
    WITHIN,
    AtlasScale,
    drawn,
    over,
    place,
    scale_of,
)
from reports.stability.results import Axis, Map, Worst

TICKS = 4  # on an axis, at most


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
    """One map; `limits` and `ticks` are in percent of its scale.

    `dot` and `bound` are how far off the worst figure is and how far it may be, in percent of the
    scale of errors, which all maps share; `bound` is None where nothing is promised.
    """

    id: str
    map: Map
    what: str
    worst: str
    limit: str
    beyond: str
    over: bool
    dot: float
    bound: float | None
    limits: list[float]
    legend: str
    ticks: tuple[tuple[float, str], ...]
    slices: list[Slice]
    columns: list[tuple[float, str]]
    rows: list[tuple[float, str]]
    box: tuple[float, float, float, float] | None
    axes: dict[str, list[str]]
    points: list[tuple[str, WorstView]]


def map_views(maps: Sequence[Map]) -> list[MapView]:
    """Everything that the page shows of maps; those of one invariant share a scale."""
    ranges: dict[str, list[tuple[float | None, float | None]]] = {}
    for found in maps:
        ranges.setdefault(found.invariant, []).append((found.at_least, found.limit))
    return [_view(found, scale_of(ranges[found.invariant])) for found in maps]


def _view(found: Map, scale: AtlasScale) -> MapView:
    id = slug("map", found.function, found.invariant, *([found.masking] if found.masking else []))
    values = np.array(
        [[[math.nan if v is None else v for v in row] for row in rows] for rows in found.values]
    )
    tried = np.array([[[v is not None for v in row] for row in rows] for rows in found.values])
    inside = _judged(found)
    beyond = over(values, found.at_least, found.limit)
    ends = [place(scale, v) for v in (found.at_least, found.limit) if v is not None]
    limits = ends[-1:] if scale.decades else ends
    worst = found.worst.value
    slices, rows, columns = found.axes
    points = [("Worst", _point(found.worst, f"{id}--worst", scale.told))]
    if found.beyond:
        told = ("Worst outside of it", _point(found.beyond, f"{id}--beyond", scale.told))
        points.append(told)
    marks = [_mark(found, values, tried & inside, found.worst, "worst")]
    if found.beyond:
        marks.append(_mark(found, values, tried & ~inside, found.beyond, "beyond"))
    return MapView(
        id=id,
        map=found,
        what=found.invariant + (f", masking {found.masking}" if found.masking else ""),
        worst=scale.told(worst, 3),
        limit=limit_text(found.at_least, found.limit),
        beyond=scale.told(found.beyond.value, 3) if found.beyond else "",
        over=not found.passed,
        dot=place(ERRORS, scale.off(worst if worst == worst else math.inf)),
        bound=None if found.limit is None else place(ERRORS, scale.off(found.limit)),
        limits=limits,
        legend=_legend(limits),
        ticks=scale.ticks,
        slices=[
            Slice(
                label=f"{name(slices.name)} {input_value(slices.values[k])}" if slices.name else "",
                uri=drawn(values[k], tried[k], beyond[k], inside[k], scale),
                marks=[m for at, m in filter(None, marks) if at == k],
                cells=_cells(values[k], tried[k], scale.told),
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
    if math.isclose(1 - at_least, limit - 1, rel_tol=1e-6):
        return f"1 ± {figure(limit - 1)}"
    return f"{at_least:.4g} to {limit:.4g}"


def _judged(found: Map) -> np.ndarray:
    """Where the limit is promised, slices x rows x columns."""
    inside = np.ones([len(a.values) for a in found.axes], bool)
    for at, axis in enumerate(found.axes):
        low, high = found.judged.get(axis.name, (-math.inf, math.inf))
        kept = [low - abs(low) * 1e-6 <= v <= high + abs(high) * 1e-6 for v in axis.values]
        inside &= np.array(kept).reshape(_along(at))
    return inside


def _mark(
    found: Map, values: np.ndarray, among: np.ndarray, worst: Worst, kind: str
) -> tuple[int, Mark] | None:
    """The slice and place of the cell of a worst point, by its inputs and else by its figure."""
    for at, axis in enumerate(found.axes):
        wanted = _input(worst, axis.name)
        if wanted is not None:
            nearest = np.abs(np.array(axis.values) - wanted).argmin()
            among = among & (np.arange(len(axis.values)) == nearest).reshape(_along(at))
    with np.errstate(invalid="ignore"):  # between infinities
        apart = np.nan_to_num(np.abs(values - worst.value), nan=math.inf)
    apart[~np.isfinite(values) & (not math.isfinite(worst.value))] = 0
    apart[~among] = math.nan
    if np.isnan(apart).all():
        return None
    k, row, column = np.unravel_index(np.nanargmin(apart), apart.shape)
    _, rows, columns = values.shape
    x, y = 100 * (column + 0.5) / columns, 100 - 100 * (row + 0.5) / rows
    return int(k), Mark(round(x, 2), round(y, 2), kind)


def _input(worst: Worst, axis: str) -> float | None:
    """Where a worst point lies on an axis, if its inputs tell."""
    if axis == "n.v" and axis not in worst.inputs and "wo" in worst.inputs:
        text = worst.inputs["wo"].split(",")[-1]  # n is z in the tangent frame
    else:
        text = worst.inputs.get(axis, "")
    try:
        return float(text)
    except ValueError:
        return None


def _along(at: int) -> list[int]:
    """The shape of what runs along one of three axes."""
    return [-1 if k == at else 1 for k in range(3)]


def _point(worst: Worst, id: str, told: Callable[[float, int], str]) -> WorstView:
    inputs = ", ".join(f"{name(n)} {v}" for n, v in worst.inputs.items())
    return WorstView(told(worst.value, 3), inputs, id, worst.command)


def _cells(values: np.ndarray, tried: np.ndarray, told: Callable[[float, int], str]) -> str:
    """Figures parted by semicolons; none where nothing was tried."""
    return ";".join(
        told(float(v), 2) if t else "" for v, t in zip(values.ravel(), tried.ravel(), strict=True)
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


def _legend(limits: Sequence[float]) -> str:
    """The bar of a scale as a CSS image: blue where a figure is allowed, orange where not."""
    low = limits[0] if len(limits) > 1 else 0.0
    high = limits[-1] if limits else 100.0
    stops = []
    for start, end, colours in ((0.0, low, OVER), (low, high, WITHIN), (high, 100.0, OVER)):
        if end > start:
            inner = [p for p in np.linspace(0, 100, len(colours)) if start < p < end]
            stops += [f"{_at(colours, p)} {p:g}%" for p in (start, *inner, end)]
    return f"linear-gradient(to right, {', '.join(stops)})"


def _at(colours: tuple[str, ...], percent: float) -> str:
    """The colour at a place of a ramp."""
    return f"rgb({' '.join(map(str, ramp(colours, 101)[round(percent)]))})"
