"""Error over time: points that move along the time axis as the meaning of time changes."""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass
from itertools import pairwise
from typing import Any, get_args

from reports.html.figures import GAP, percent, seconds, similarity, size, slug
from reports.html.logaxis import LogAxis
from reports.html.speed.labels import Label, places
from reports.speed.pareto import Measured, Standing, Way, front, standings
from reports.speed.points import Bench, Change, Error, Family, Point

FAMILIES = get_args(Family)
ABSENT = Measured(math.nan, math.nan, math.nan)


@dataclass(frozen=True)
class Mode:
    """A meaning of time: its name on the switch, its explanation, and the seconds of a point."""

    name: str
    meaning: str
    seconds: Callable[[Point], Measured]


def _warm(point: Point) -> Measured:
    return Measured(point.frame.median, point.frame.low, point.frame.high)


def _shared(frames: int) -> Callable[[Point], Measured]:
    """A frame and its share of what is made once."""

    def measure(point: Point) -> Measured:
        more = point.seconds_over(frames) - point.frame.median
        return Measured(
            *(s + more for s in (point.frame.median, point.frame.low, point.frame.high))
        )

    return measure


def _after(change: Change) -> Callable[[Point], Measured]:
    """The next frame after a change; its spread was not measured: it beats none for sure."""
    return lambda point: Measured(point.after.get(change, math.nan), math.nan, math.nan)


MODES = (
    Mode("warm", "the median of frames once all is made; its bar spans the quartiles", _warm),
    *(
        Mode(f"over {n:,}", f"a frame and its share of compilation, precomputation and "
             f"preparation, where they serve {n:,} frame{'s' * (n > 1)}", _shared(n))
        for n in (10_000, 60, 1)
    ),
    *(
        Mode(f"new {c}", f"until the next finished frame once the {c} has changed", _after(c))
        for c in get_args(Change)
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Quantity:
    """An error that is drawn: the field of Error, its names, and how it and its ticks read."""

    field: str
    name: str
    inline: str
    show: Callable[[float], str]
    tick: Callable[[float], str]

    def of(self, error: Error | None) -> Measured:
        """The figure with its interval; unknown where there is none."""
        if error is None:
            return ABSENT
        figure = getattr(error, self.field)
        return Measured(figure.value, figure.low, figure.high)


QUANTITIES = (
    Quantity(
        "energy_local",
        "Local energy error",
        "local energy error",
        percent,
        lambda v: f"{100 * v:g}{GAP}%",
    ),
    Quantity("one_minus_ssim", "1 − SSIM", "1 − SSIM", similarity, lambda v: f"{v:g}"),
)


@dataclass(frozen=True)
class State:
    """A point under one meaning of time; places are percentages of the plot.

    Attributes:
        low: the left end of the interval of its time, `high` the right end.
        time: in words.
        side: of the point, where its label goes; empty where there is no room.
    """

    x: float
    low: float
    high: float
    time: str
    standing: Standing
    side: str


@dataclass(frozen=True)
class Spot:
    """A point on a plot; places are percentages, down from the top.

    Attributes:
        states: by mode; one in which it has no place is left out.
        off: whether the error is 0 or less and the point lies on the lower edge for that.
    """

    point: Point
    label: str
    y: float
    top: float
    bottom: float
    off: bool
    error: str
    memory: str
    row: str
    states: dict[str, State]

    @property
    def moves(self) -> dict[str, list[Any]]:
        """Its states as JSON can hold them, in the order of State's fields."""
        return {mode: list(astuple(state)) for mode, state in self.states.items()}


@dataclass(frozen=True)
class Path:
    """A line on a plot, by mode, as SVG path data in percentages."""

    kind: str
    d: dict[str, str]


@dataclass(frozen=True)
class Plot:
    """One error of one object over time, on axes that all objects of the case share."""

    quantity: Quantity
    spots: list[Spot]
    paths: list[Path]
    x_ticks: list[tuple[float, str]]
    y_ticks: list[tuple[float, str]]


def modes_of(bench: Bench) -> list[Mode]:
    """The meanings of time that a bench has figures for."""
    return [m for m in MODES if any(math.isfinite(m.seconds(p).value) for p in bench.points)]


def plots(points: Sequence[Point], object_name: str, modes: Sequence[Mode]) -> list[Plot]:
    """The plots of one object of a case: one for each quantity that has figures."""
    drawn = (_plot(points, object_name, q, modes) for q in QUANTITIES)
    return [plot for plot in drawn if plot.spots]


def error_of(point: Point, object_name: str) -> Error | None:
    """The errors of one object."""
    return next((e for e in point.errors if e.object == object_name), None)


def series_of(point: Point) -> tuple[str, str]:
    """What a point shares with those that differ from it in samples only."""
    name = re.sub(rf"(?<!\d){point.samples}(?!\d)", "", point.name) if point.samples else point.name
    return point.family, name


def _plot(
    points: Sequence[Point], object_name: str, quantity: Quantity, modes: Sequence[Mode]
) -> Plot:
    x = LogAxis.around(s for p in points for m in modes for s in _span(m.seconds(p)))
    y = LogAxis.around(quantity.of(e).value for p in points for e in p.errors)
    shown = [p for p in points if math.isfinite(quantity.of(error_of(p, object_name)).value)]
    errors = [quantity.of(error_of(p, object_name)) for p in shown]
    states: list[dict[str, State]] = [{} for _ in shown]
    paths: dict[str, dict[str, str]] = {}
    for mode in modes:
        times = [mode.seconds(p) for p in shown]
        ways = [Way(t, e) for t, e in zip(times, errors, strict=True)]
        spots = [(x.at(w.cost.value), _down(y, w.error.value)) for w in ways]
        stands = standings(ways)
        tags = places([
            Label(*spot, tag(p), stand) for spot, p, stand in zip(spots, shown, stands, strict=True)
        ])  # fmt: skip
        for state, time, spot, stand, place in zip(states, times, spots, stands, tags, strict=True):
            if stand:
                low, high = (x.at(v) if v == v else spot[0] for v in (time.low, time.high))
                state[mode.name] = State(spot[0], low, high, _within(time), stand, place)
        best = [spots[i] for i in front(ways)]
        for name, d in [("front", _stairs(best)), *_joined(shown, spots, stands)]:
            paths.setdefault(name, {})[mode.name] = d
    return Plot(
        quantity=quantity,
        spots=[_spot(*found, quantity, y) for found in zip(shown, errors, states, strict=True)],
        paths=[Path(name, d) for name, d in paths.items()],
        x_ticks=x.labelled(_time_tick),
        y_ticks=[(round(100 - at, 2), label) for at, label in y.labelled(quantity.tick)],
    )


def _spot(
    point: Point, error: Measured, states: dict[str, State], quantity: Quantity, y: LogAxis
) -> Spot:
    top, bottom = (_down(y, v if v == v else error.value) for v in (error.high, error.low))
    told = quantity.show(error.value)
    if error.low == error.low and error.high == error.high:
        told += f" ({quantity.show(error.low)} to {quantity.show(error.high)})"
    return Spot(
        point, tag(point), _down(y, error.value), top, bottom, error.value <= 0, told,
        size(point.memory) if point.memory == point.memory else "", row_id(point), states,
    )  # fmt: skip


def tag(point: Point) -> str:
    """How a point is called on the plot: a path tracer by its samples, its colour says the rest."""
    return point.name if point.family == "real-time" else str(point.samples)


def row_id(point: Point) -> str:
    """The HTML id of a point's row in the table of its case."""
    return slug("speed", point.case, point.family, point.name)


def _joined(
    points: Sequence[Point], spots: Sequence[tuple[float, float]], stands: Sequence[Standing | None]
) -> list[tuple[str, str]]:
    """Lines through the points that differ in samples only, by family and in order of samples."""
    series: dict[tuple[str, str], list[tuple[int, tuple[float, float]]]] = {}
    for point, spot, stand in zip(points, spots, stands, strict=True):
        if point.samples and stand:
            series.setdefault(series_of(point), []).append((point.samples, spot))
    lines: dict[str, str] = {}
    for (family, _), joined in series.items():
        line = "M" + "L".join(f"{x:g} {y:g}" for _, (x, y) in sorted(joined))
        lines[family] = lines.get(family, "") + line
    return list(lines.items())


def _stairs(best: Sequence[tuple[float, float]]) -> str:
    """The front as a stair, from the upper edge over its points to the right edge."""
    if not best:
        return ""
    steps = "".join(f"V{y:g}H{x:g}" for (_, y), (x, _) in pairwise(best))
    return f"M{best[0][0]:g} 0{steps}V{best[-1][1]:g}H100"


def _span(time: Measured) -> list[float]:
    return [v for v in (time.value, time.low, time.high) if v == v]


def _down(axis: LogAxis, value: float) -> float:
    return round(100 - axis.at(value), 2)


def _within(time: Measured) -> str:
    """A time, with its quartiles where they are told apart."""
    ends = [seconds(v) for v in (time.low, time.high)]
    if time.low != time.low or ends[0] == ends[1]:
        return seconds(time.value)
    return f"{seconds(time.value)} ({ends[0]} to {ends[1]})"


def _time_tick(value: float) -> str:
    return f"{value:g}{GAP}s" if value >= 1 else f"{1e3 * value:g}{GAP}ms"
