"""Limits of detection as charts: dots with intervals, and how often each size is caught."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import altair as alt
from markupsafe import Markup

from reports.html.charts import INK, SERIES_COLOURS, WIDTH, Axis, Chart, Line, drawn, line_chart
from reports.html.figures import digits
from reports.html.logaxis import LogAxis
from reports.limits.results import EVERY, Limit, Point

WHOLE = "whole suite"
SIGNS = {"+": "plus", "-": "minus"}
UNITS = {"": "On a scale of 0 to 1", "relative": "Relative", "degrees": "Angles"}
ROW = 22  # px between two errors
NAMES = 150  # px for their names, whatever the font of who reads
Size = Callable[[float, str], str]


@dataclass(frozen=True)
class Plot:
    """The limits of one unit: a dot with its interval for each error."""

    title: str
    svg: Markup


@dataclass(frozen=True)
class Curves:
    """How often each size of one error is caught; `said` tells what the lines do not show."""

    chart: Chart
    said: list[str] = field(default_factory=list)


def plots(limits: Sequence[Limit], told: Callable[[Limit], str], size: Size) -> list[Plot]:
    """One plot for each unit, of what the whole suite catches.

    Args:
        told: what stands in place of the dot of a limit that has none; empty where it has one.
        size: a size with its unit, as text.
    """
    groups = {u: [x for x in limits if x.unit == u and x.curve] for u in UNITS}
    return [_plot(group, unit, told, size) for unit, group in groups.items() if group]


def _plot(group: Sequence[Limit], unit: str, told: Callable[[Limit], str], size: Size) -> Plot:
    records = []
    for found in group:
        record = {"error": f"{found.parameter} {'+' if found.sign == '+' else '−'}"}
        if words := told(found):
            record["told"] = words
        else:
            places = {"at": found.smallest, "bare": found.noiseless}
            ends = {"low": found.low or found.smallest, "high": found.high or found.smallest}
            record |= {k: v for k, v in (places | ends).items() if v is not None}
        records.append(record)
    placed = [v for r in records for v in r.values() if not isinstance(v, str)]
    axis = LogAxis.around(placed)
    shown = Axis("", (axis.low, axis.high), axis.ticks(), lambda v: size(v, unit), log=True)
    base = alt.Chart(alt.Data(values=records)).encode(
        y=alt.Y(
            "error:N", sort=None, title=None, axis=alt.Axis(grid=True, ticks=False, minExtent=NAMES)
        )
    )

    def along(name: str) -> alt.X:
        return alt.X(f"{name}:Q", title=None, axis=shown.drawn, scale=shown.scale)

    valid = base.transform_filter("isValid(datum.at)")
    colour = alt.value(SERIES_COLOURS[0])
    chart = alt.layer(
        valid.mark_rule(strokeWidth=2).encode(x=along("low"), x2="high:Q", color=colour),
        valid.mark_point(filled=True, size=50, opacity=1).encode(x=along("at"), color=colour),
        base.transform_filter("isValid(datum.bare)")
        .mark_tick(thickness=2, size=14, opacity=1)
        .encode(x=along("bare"), color=alt.value(INK)),
        base.transform_filter("isValid(datum.told)")
        .mark_text(align="left", dx=4, fontSize=11)
        .encode(x=alt.value(0), text="told:N", color=alt.value("var(--over)")),
        width=WIDTH,
        height=alt.Step(ROW),
    )
    what = "The smallest errors that are caught, with their intervals; the table tells them too."
    return Plot(UNITS[unit], drawn(chart, f"Limits of detection: {UNITS[unit]}", what))


def curves(limits: Sequence[Limit], size: Size) -> list[Curves]:
    """By parameter, the share that is caught over the size, in as many charts as there is room."""
    made = []
    for parameter in dict.fromkeys(found.parameter for found in limits):
        group = [found for found in limits if found.parameter == parameter and found.curve]
        made += _of_parameter(group, size)
    return made


def _of_parameter(group: Sequence[Limit], size: Size) -> list[Curves]:
    """Of a line for each technique and sign those that rise; the others are told."""
    single = [found for found in group if found.technique != EVERY]
    lines, never, twins = [], [], []
    for found in sorted(group, key=lambda f: f.technique == EVERY):
        alike = [f for f in single if f is not found and f.sign == found.sign and _same(f, found)]
        if found.technique == EVERY and alike:
            twins.append((SIGNS[found.sign], alike[0].technique))
        elif not any(p.caught for p in found.curve):
            most = size(found.curve[-1].size, found.unit)
            never.append(f"{_named(found)}, {SIGNS[found.sign]} (up to {most})")
        else:
            lines.append(found)
    said = []
    if twins:
        parts = (f"{sign} as {technique}" for sign, technique in twins)
        said.append(f"The whole suite: {', '.join(parts)}.")
    if never:
        said.append(f"Never caught: {'; '.join(never)}.")
    names, room = list(dict.fromkeys(f.technique for f in lines)), len(SERIES_COLOURS)
    charts = [
        _chart([f for f in lines if f.technique in names[k : k + room]], size)
        for k in range(0, len(names), room)
    ]
    return [Curves(chart, said if chart is charts[0] else []) for chart in charts]


def _same(one: Limit, other: Limit) -> bool:
    return _shares(one.curve) == _shares(other.curve)


def _shares(curve: Sequence[Point]) -> list[tuple[float, int, int]]:
    return [(p.size, p.caught, p.of) for p in curve]


def _named(found: Limit) -> str:
    return WHOLE if found.technique == EVERY else found.technique


def _chart(group: Sequence[Limit], size: Size) -> Chart:
    unit = group[0].unit
    x = sorted({p.size for found in group for p in found.curve})
    lines = []
    for found in group:
        at = {p.size: 100 * p.caught / p.of for p in found.curve if p.of}
        lines.append(Line(_named(found), SIGNS[found.sign], [at.get(s, math.nan) for s in x]))
    axis = LogAxis.around(x)
    return line_chart(
        group[0].parameter,
        f"How often of 100 times the gate fails, from {size(x[0], unit)} to {size(x[-1], unit)}.",
        Axis("error", (axis.low, axis.high), axis.ticks(), lambda v: size(v, unit), log=True),
        Axis("caught of 100", (0, 100), (0, 50, 95)),
        x,
        lines,
        series_title=None,
        told=digits,
    )
