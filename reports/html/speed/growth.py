"""Small multiples: cost over size, and samples over the weight of a mixture."""

import math
from collections.abc import Callable, Sequence

from reports.html.charts import Axis, Chart, Line, by_colours, line_chart
from reports.html.figures import GAP, digits, seconds, size
from reports.html.logaxis import LogAxis
from reports.html.speed.words import COSTS, sizes_of
from reports.results import Figured
from reports.speed.points import Growth, LobeSampling

SAMPLERS = {"ggx": "GGX", "mixture": "mixture", "beckmann": "Beckmann"}
UNKNOWN = Figured(value=math.nan, low=math.nan, high=math.nan)


def growth_charts(growths: Sequence[Growth]) -> list[tuple[Chart, list[Growth]]]:
    """One chart for each cost and what it grows with, beside the growths that it shows."""
    groups: dict[tuple[str, str], list[Growth]] = {}
    for found in growths:
        groups.setdefault((found.over, found.cost), []).append(found)
    return [
        (_growth_chart(part), list(part))
        for group in groups.values()
        for part in by_colours(group)
    ]  # fmt: skip


def lobe_charts(lobes: Sequence[LobeSampling]) -> dict[str, list[Chart]]:
    """By light, one chart for each roughness and angle: directions to 1 % over the weight."""
    axis = LogAxis.around(v for s in lobes for v in (s.samples.value, s.samples.high))
    charts: dict[str, list[Chart]] = {}
    for place in sorted({_place(s) for s in lobes}):
        here = [s for s in lobes if _place(s) == place]
        charts.setdefault(place[0], []).append(_lobe_chart(here, axis))
    return charts


def _growth_chart(group: Sequence[Growth]) -> Chart:
    over, cost = sizes_of(group[0]), group[0].cost
    x = sorted({s for g in group for s in g.sizes})
    lines = []
    for found in group:
        at = dict(zip(found.sizes, found.values, strict=True))
        lines.append(Line(found.technique, "measured", [at.get(s, math.nan) for s in x]))
    show = size if cost == "memory" else seconds
    return line_chart(
        f"{COSTS[cost].capitalize()} over {over}",
        f"{COSTS[cost].capitalize()} from {show(_least(lines))} to {show(_most(lines))}.",
        _log(over, LogAxis.around(x), short),
        _log(COSTS[cost], LogAxis.around(v for line in lines for v in line.y), show),
        x,
        lines,
        series_title=None,
        told=show,
    )


def _lobe_chart(here: Sequence[LobeSampling], axis: LogAxis) -> Chart:
    light, cos_theta, roughness = _place(here[0])
    x = sorted({s.weight for s in here})
    lines = []
    for sampler, points in dict.fromkeys((s.sampler, s.points) for s in here):
        at = {s.weight: s.samples for s in here if (s.sampler, s.points) == (sampler, points)}
        found = [at.get(w, UNKNOWN) for w in x]
        ends = [(f.low, f.high) for f in found]
        lines.append(Line(SAMPLERS[sampler], points, [f.value for f in found], ends))
    return line_chart(
        f"Roughness {roughness:g}, n·v {cos_theta:g}",
        f"Directions to 1 % in {light}, from {digits(_least(lines))} to {digits(_most(lines))}.",
        Axis("weight (share of GGX)", (x[0], x[-1]), x),
        _log("directions to 1 %", axis, short),
        x,
        lines,
        series_title=None,
        told=digits,
    )


def _place(sampling: LobeSampling) -> tuple[str, float, float]:
    return sampling.light, sampling.cos_theta, sampling.roughness


def short(value: float) -> str:
    """A round number as an axis has room for it, such as 500 k."""
    power, name = next(((p, n) for p, n in ((1e6, "M"), (1e3, "k")) if value >= p), (1, ""))
    return f"{value / power:g}{GAP if name else ''}{name}"


def _log(title: str, axis: LogAxis, show: Callable[[float], str]) -> Axis:
    return Axis(title, (axis.low, axis.high), axis.ticks(), show, log=True)


def _least(lines: Sequence[Line]) -> float:
    return min((y for line in lines for y in line.y if y == y), default=math.nan)


def _most(lines: Sequence[Line]) -> float:
    return max((y for line in lines for y in line.y if y == y), default=math.nan)
