"""Line charts as inline SVG in the page's own colours, with the numbers they show."""

import json
import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import altair as alt
import vl_convert
from markupsafe import Markup, escape

# Read by the browser from report.css, so that a chart follows the page's light or dark theme.
SERIES_COLOURS = ["var(--series1)", "var(--series2)", "var(--series3)", "var(--series4)"]
SHAPES = ["circle", "square", "triangle-up", "diamond"]  # colour is never the only difference
T = TypeVar("T")
INK, SOFT, LINE = "currentColor", "var(--soft)", "var(--line)"
WIDTH, HEIGHT = 290, 190


@dataclass(frozen=True)
class Line:
    """One line of a chart: the series it belongs to (colour and mark), its style, and y by x.

    `ends` are the intervals of y, drawn as bars. What is NaN is not drawn.
    """

    series: str
    style: str
    y: Sequence[float]
    ends: Sequence[tuple[float, float]] = ()


@dataclass(frozen=True)
class Chart:
    """A drawn chart; `header` and `rows` are its numbers as a table."""

    title: str
    svg: Markup
    header: list[str]
    rows: list[list[str]]


@dataclass(frozen=True)
class Axis:
    """An axis: its title, its two ends, its ticks and how a number on it reads.

    Without ticks the chart chooses some five, shown as plain numbers.
    """

    title: str
    ends: tuple[float, float]
    ticks: Sequence[float] = ()
    show: Callable[[float], str] = "{:g}".format
    log: bool = False

    @property
    def drawn(self) -> alt.Axis:
        """Its ticks and labels."""
        if not self.ticks:
            return alt.Axis(tickCount=5)
        labels = json.dumps([self.show(t) for t in self.ticks])
        places = json.dumps(list(self.ticks))
        return alt.Axis(
            values=list(self.ticks),
            labelExpr=f"{labels}[indexof({places}, datum.value)]",
            labelOverlap=True,
            labelSeparation=6,
            labelFlush=False,
        )

    @property
    def scale(self) -> alt.Scale:
        """Its scale; what lies beyond an end is drawn at that end."""
        kind = "log" if self.log else "linear"
        return alt.Scale(type=kind, domain=self.ends, nice=False, clamp=self.log)


def by_colours(series: Sequence[T]) -> Iterator[Sequence[T]]:
    """Series in groups of as many as a chart has colours."""
    step = len(SERIES_COLOURS)
    return (series[i : i + step] for i in range(0, len(series), step))


def line_chart(
    title: str,
    description: str,
    x_axis: Axis,
    y_axis: Axis,
    x: Sequence[float],
    lines: Sequence[Line],
    *,
    series_title: str | None,
    told: Callable[[float], str],
) -> Chart:
    """Draw lines over common x.

    Args:
        description: what a reader who cannot see the chart should know.
        series_title: what the names of the series say; None where they need no title.
        lines: up to four series, each in up to two styles (solid with marks,
            dashed without, by first appearance).
        told: how a y reads in the table.
    """
    series = list(dict.fromkeys(line.series for line in lines))
    styles = list(dict.fromkeys(line.style for line in lines))
    series_key = alt.Legend(
        title=series_title,
        titleOrient="left",
        titlePadding=14,
        symbolSize=60,
        symbolOpacity=1,
        columns=0 if series_title else 3,  # 0 is one row: names under a title are short
    )
    styles_key = alt.Legend(
        title=None,
        orient="bottom",
        offset=4,
        symbolType="stroke",
        symbolSize=400,
        symbolStrokeColor=INK,
    )
    base = alt.Chart(alt.Data(values=_values(x, lines))).encode(
        x=alt.X("x:Q", title=x_axis.title, axis=x_axis.drawn, scale=x_axis.scale),
        y=alt.Y("y:Q", title=y_axis.title, axis=y_axis.drawn, scale=y_axis.scale),
        color=alt.Color("series:N", sort=None, legend=series_key).scale(
            domain=series, range=SERIES_COLOURS[: len(series)]
        ),
    )
    dashes = alt.StrokeDash(
        "style:N", sort=None, legend=styles_key if len(styles) > 1 else None
    ).scale(domain=styles, range=[[1, 0], [5, 3]][: len(styles)])
    styled = base.mark_line(strokeWidth=1.6).encode(strokeDash=dashes)
    barred = (
        base.transform_filter("isValid(datum.low)")
        .mark_rule(opacity=0.6)
        .encode(y=alt.Y("low:Q"), y2="high:Q")
    )
    marked = (
        base.transform_filter(alt.datum.style == styles[0])
        .mark_point(filled=True, size=24, opacity=1)
        .encode(
            shape=alt.Shape("series:N", sort=None, legend=series_key).scale(
                domain=series, range=SHAPES[: len(series)]
            )
        )
    )
    chart = alt.layer(styled, barred, marked, width=WIDTH, height=HEIGHT)
    names = [", ".join([line.series, *([line.style] if len(styles) > 1 else [])]) for line in lines]
    return Chart(
        title=title,
        svg=drawn(chart, title, description),
        header=[x_axis.title, *names],
        rows=[[x_axis.show(at), *(told(line.y[i]) for line in lines)] for i, at in enumerate(x)],
    )


def drawn(chart: alt.LayerChart, title: str, description: str) -> Markup:
    """A chart in the page's type and colours, as one image with a name."""
    styled = (
        chart
        .configure(background="transparent", font="system-ui, sans-serif")
        .configure_axis(
            labelColor=SOFT, titleColor=INK, gridColor=LINE, domainColor=SOFT, tickColor=SOFT,
            titleFontWeight="normal", labelFontSize=11, titleFontSize=12,
        )
        .configure_legend(
            orient="top", labelColor=INK, labelFontSize=11, symbolBaseStrokeColor=INK,
            titleColor=SOFT, titleFontWeight="normal", titleFontSize=11,
        )
        .configure_view(stroke=None)
    )  # fmt: skip
    return _inline(vl_convert.vegalite_to_svg(styled.to_dict()), title, description)


def _values(x: Sequence[float], lines: Sequence[Line]) -> list[dict[str, Any]]:
    """One record for each mark; what is no number is left out, since JSON has none."""
    records = []
    for line in lines:
        ends = line.ends or [(math.nan, math.nan)] * len(x)
        for at, y, (low, high) in zip(x, line.y, ends, strict=True):
            figures = {"x": at, "y": y, "low": low, "high": high}
            known = {name: float(f"{v:.5g}") for name, v in figures.items() if math.isfinite(v)}
            if "y" in known:
                records.append(known | {"series": line.series, "style": line.style})
    return records


def _inline(svg: str, title: str, description: str) -> Markup:
    """The SVG as one image with a name, without what only a file of its own or a script needs."""
    body = re.sub(r'<svg [^>]*?(viewBox="[^"]+")[^>]*>', "", svg, count=1)
    view_box = re.search(r'viewBox="[^"]+"', svg)
    if view_box is None:
        raise ValueError("vl-convert gave an SVG without a viewBox")
    body = re.sub(r' (aria-[a-z]+|role|class|pointer-events)="[^"]*"', "", body)
    body = re.sub(r'<text [^>]*opacity="0"[^>]*>[^<]*</text>', "", body)  # labels left out
    body = body.replace(' opacity="1"', "").replace(' font-family="system-ui, sans-serif"', "")
    body = re.sub(r'<path d="[^"]*"( display="none")?/>', "", body)  # backgrounds
    # A tenth of a unit is a tenth of a pixel or less.
    body = re.sub(
        r' (?:d|transform)="[^"]*"', lambda found: re.sub(r"(\.\d)\d+", r"\1", found[0]), body
    )
    return Markup(
        f'<svg {view_box[0]} role="img" fill="none" aria-label="{escape(title)}">'
        f"<title>{escape(title)}</title><desc>{escape(description)}</desc>"
    ) + Markup(body)
