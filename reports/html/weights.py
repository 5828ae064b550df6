"""Error over the weight of a mixture, one chart for each figure, place, material and truth."""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby

from reports.html.charts import Axis, Chart, Line, by_colours, line_chart
from reports.html.figures import GAP, METRICS, percent, similarity
from reports.html.logaxis import LogAxis
from reports.html.matrix import label_of
from reports.results import Row

FEWEST = 3  # weights; two make no curve
LEAST = 1e-6  # an interval may reach below 0, a logarithmic axis does not


@dataclass(frozen=True)
class WeightChart:
    """A chart of rows that stand against one truth."""

    truth: str
    chart: Chart


def weight_charts(rows: list[Row]) -> list[WeightChart]:
    """Local energy error and SSIM over the share of GGX, wherever a run has three weights."""

    def place(row: Row) -> tuple[str, ...]:
        masking = "" if row.weight_g == row.weight else f", masking of weight {row.weight_g:g}"
        where = f"{row.scene} in {row.environment}"
        return row.truth, f"{label_of(row, rows)}{masking}, {where}"

    made = []
    for (truth, title), group in groupby(sorted(rows, key=place), place):
        here = list(group)
        if len({r.weight for r in here}) < FEWEST:
            continue
        for chart in _charts(title, here):
            made.append(WeightChart(truth, chart))
    return made


def _charts(title: str, rows: list[Row]) -> Iterator[Chart]:
    for some in by_colours(list(dict.fromkeys(r.technique for r in rows))):
        shown = [r for r in rows if r.technique in some]
        yield _chart(title, "energy_local", shown, _log, percent, max)
        yield _chart(title, "ssim", shown, _up_to_1, similarity, min)


def _chart(
    title: str,
    name: str,
    rows: list[Row],
    axis: Callable[[str, list[float]], Axis],
    show: Callable[[float], str],
    worst: Callable[..., Row],
) -> Chart:
    metric = METRICS[name]
    weights = sorted({r.weight for r in rows})
    lines = []
    for technique in dict.fromkeys(r.technique for r in rows):
        own = [r for r in rows if r.technique == technique and math.isfinite(metric.value(r))]
        at = {w: [r for r in own if r.weight == w] for w in weights}
        told = [worst(at[w], key=metric.value) if at[w] else None for w in weights]
        values = [metric.value(r) if r else math.nan for r in told]
        ends = [metric.bounds(r) if r else (math.nan, math.nan) for r in told]
        ends = [(max(low, LEAST), high) for low, high in ends]
        lines.append(Line(technique, "measured", values, ends))
    known = [v for line in lines for v in line.y if v == v]
    span = f"from {show(min(known))} to {show(max(known))}" if known else "not measured"
    return line_chart(
        title,
        f"{metric.label} over the share of GGX: {span}.",
        Axis("weight (share of GGX)", (weights[0], weights[-1]), weights),
        axis(metric.label, [*known, *_finite(v for line in lines for e in line.ends for v in e)]),
        weights,
        lines,
        series_title=None,
        told=show,
    )


def _log(title: str, values: list[float]) -> Axis:
    axis = LogAxis.around(v for v in values if v > 0)
    return Axis(title, (axis.low, axis.high), axis.ticks(), _short, log=True)


def _short(value: float) -> str:
    return f"{100 * value:g}{GAP}%"


def _up_to_1(title: str, values: list[float]) -> Axis:
    low = math.floor(20 * min(values, default=0.95)) / 20
    return Axis(title, (low, 1.0))


def _finite(values: Iterable[float]) -> list[float]:
    return [v for v in values if math.isfinite(v)]
