"""Line charts as inline SVG in the page's own colours, with the numbers they show."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import altair as alt
import vl_convert
from markupsafe import Markup, escape

# Read by the browser from report.css, so that a chart follows the page's light or dark theme.
SERIES_COLOURS = ["var(--series1)", "var(--series2)", "var(--series3)", "var(--series4)"]
SHAPES = ["circle", "square", "triangle-up", "diamond"]  # colour is never the only difference
INK, SOFT, LINE = "currentColor", "var(--soft)", "var(--line)"
WIDTH, HEIGHT = 290, 190


@dataclass(frozen=True)
class Line:
    """One line of a chart: the series it belongs to (colour and mark), its style, and y by x."""

    series: str
    style: str
    y: Sequence[float]


@dataclass(frozen=True)
class Chart:
    """A drawn chart; `header` and `rows` are its numbers as a table."""

    title: str
    svg: Markup
    header: list[str]
    rows: list[list[str]]


def line_chart(
    title: str,
    description: str,
    x_title: str,
    y_title: str,
    x: Sequence[float],
    lines: Sequence[Line],
    *,
    series_title: str,
    x_ticks: Sequence[float],
    y_range: tuple[float, float],
    unit: str = "%",
) -> Chart:
    """Draw lines over common x.

    Args:
        description: what a reader who cannot see the chart should know.
        series_title: what the names of the series say.
        lines: up to four series, each in up to two styles (solid with marks,
            dashed without, by first appearance).
        y_range: ends of the y axis, in the unit of the lines' y.
    """
    series = list(dict.fromkeys(line.series for line in lines))
    styles = list(dict.fromkeys(line.style for line in lines))
    values = [
        {"x": at, "y": round(y, 3), "series": line.series, "style": line.style}
        for line in lines
        for at, y in zip(x, line.y, strict=True)
    ]
    series_key = alt.Legend(title=series_title, titleOrient="left", titlePadding=14, symbolSize=60)
    styles_key = alt.Legend(
        title=None,
        orient="bottom",
        offset=4,
        symbolType="stroke",
        symbolSize=400,
        symbolStrokeColor=INK,
    )
    base = alt.Chart(alt.Data(values=values)).encode(
        x=alt.X(
            "x:Q", title=x_title, axis=alt.Axis(values=x_ticks, labelExpr="'' + datum.value")
        ).scale(domain=[x_ticks[0], x_ticks[-1]], nice=False),
        y=alt.Y("y:Q", title=y_title, axis=alt.Axis(tickCount=5)).scale(domain=y_range, nice=False),
        color=alt.Color("series:N", sort=None, legend=series_key).scale(
            domain=series, range=SERIES_COLOURS[: len(series)]
        ),
    )
    styled = base.mark_line(strokeWidth=1.6).encode(
        strokeDash=alt.StrokeDash("style:N", sort=None, legend=styles_key).scale(
            domain=styles, range=[[1, 0], [5, 3]][: len(styles)]
        )
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
    chart = (
        alt.layer(styled, marked, width=WIDTH, height=HEIGHT)
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
    svg = vl_convert.vegalite_to_svg(chart.to_dict())
    return Chart(
        title=title,
        svg=_inline(svg, title, description),
        header=[x_title, *(f"{line.series}, {line.style}" for line in lines)],
        rows=[
            [f"{at:g}", *(f"{line.y[i]:.1f} {unit}" for line in lines)] for i, at in enumerate(x)
        ],
    )


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
