"""What a bench prints: time and error per case and way, and what equal error takes."""

import math
import statistics
from collections.abc import Sequence

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from reports.results import Figured
from reports.speed.points import FIGURES, Bench, EqualError, Family, Point

AMORTISED = (1, 60, 10_000)  # frames
FULL = (1920, 1080)
NAMES = {"energy_local": "local energy", "one_minus_ssim": "SSIM"}


def print_bench(bench: Bench, console: Console) -> None:
    """Two tables, of the points and of equal error, and the ratio at full size."""
    console.print(_points(bench))
    console.print(
        "Time: warm, serial; median with quartiles. Ratio: to a frame of 1 Mitsuba sample. Over n "
        "frames: seconds a frame with compilation, precomputation and preparation shared out. "
        "Errors: mean over the case's objects whose error is known, against `global`.",
        style="dim",
    )
    if bench.equal:
        console.print(_equal(bench.equal))
        console.print(
            "Samples per pixel at equal error, and Mitsuba's time for them over the technique's: "
            "above 1 the technique is faster. '< 1': one sample is better already. '> most': more "
            "than were measured.",
            style="dim",
        )
    for line in _full_size(bench):
        console.print(line, markup=False, soft_wrap=True)
    for line in bench.skipped:
        console.print(f"left out: {line}", style="dim", markup=False, soft_wrap=True)


def _points(bench: Bench) -> Table:
    table = Table(box=box.SIMPLE_HEAD, title=f"{bench.suite}: speed against error")
    table.add_column("way", overflow="fold")  # cases may differ at the end of their names
    headings = ["ms", "fps", "GPU ms", "ratio", *(f"over {n:,}" for n in AMORTISED)]
    for heading in (*headings, "local energy", "1-SSIM"):
        table.add_column(heading, justify="right")
    for case, points in _by_case(bench.points).items():
        first = points[0]
        label = f"{case}, {first.width}x{first.height}"
        table.add_row(Text(label, style="bold"))
        one = one_sample(points)
        for p in points:
            table.add_row(f"  {p.name}", *_cells(p, one))
        table.add_section()
    return table


def _cells(point: Point, one: float) -> list[str]:
    """Everything about a point, given the seconds of one sample per pixel."""
    frame = point.frame
    errors = [_mean(point, figure) for figure in FIGURES]
    return [
        f"{_ms(frame.median)} ({_ms(frame.low)} to {_ms(frame.high)})",
        _digits(1 / frame.median),
        _ms(point.gpu.median) if point.gpu else "",
        _digits(frame.median / one),
        *(f"{_digits(point.seconds_over(n))} s" for n in AMORTISED),
        "unknown" if math.isnan(errors[0]) else f"{errors[0]:.2%}",
        "unknown" if math.isnan(errors[1]) else f"{errors[1]:.4f}",
    ]


def _mean(point: Point, figure: str) -> float:
    """Of one error, over the objects of which it is known."""
    values = [getattr(e, figure).value for e in point.errors]
    known = [v for v in values if not math.isnan(v)]
    return statistics.fmean(known) if known else math.nan


def _equal(equal: Sequence[EqualError]) -> Table:
    """A line per case, object and technique, and a column per family and figure."""
    table = Table(box=box.SIMPLE_HEAD, title="What path tracing needs to be as good")
    table.add_column("object, technique", overflow="fold")
    columns = list(dict.fromkeys((e.against, e.figure) for e in equal))
    for against, figure in columns:
        table.add_column(f"{against}, {NAMES[figure]}", justify="right")
    cases: dict[str, dict[str, dict[tuple[Family, str], EqualError]]] = {}
    for e in equal:
        lines = cases.setdefault(e.case, {})
        lines.setdefault(f"  {e.object}, {e.technique}", {})[e.against, e.figure] = e
    for case, lines in cases.items():
        table.add_row(Text(case, style="bold"))
        for label, found in lines.items():
            table.add_row(label, *(_need(found.get(column)) for column in columns))
        table.add_section()
    return table


def _need(found: EqualError | None) -> str:
    """Samples and the ratio of times, or why there are none."""
    if found is None:
        return ""
    if math.isnan(found.samples.value):
        return {"below": "< 1", "above": "> most"}.get(found.beyond, "unknown")
    return f"{_interval(found.samples)}; time x {_interval(found.ratio)}"


def _interval(figure: Figured) -> str:
    ends = (_digits(end) if math.isfinite(end) else "?" for end in (figure.low, figure.high))
    return f"{_digits(figure.value)} ({' to '.join(ends)})"


def _full_size(bench: Bench) -> list[str]:
    """A line per case at 1920x1080: each technique's frame over one sample of Mitsuba."""
    lines = []
    for case, points in _by_case(bench.points).items():
        one = one_sample(points)
        if (points[0].width, points[0].height) != FULL or math.isnan(one):
            continue
        ratios = [f"{p.name} {p.frame.median / one:.3f}" for p in points if p.family == "real-time"]
        size = "x".join(map(str, FULL))
        lines.append(f"{size} ratio to Mitsuba 1 sample, {case}: {', '.join(ratios)}")
    return lines


def one_sample(points: Sequence[Point]) -> float:
    """Seconds of one path-traced sample per pixel at a case's size; NaN where it is not there."""
    found = [p for p in points if (p.family, p.samples) == ("path traced", 1)]
    return found[0].frame.median if found else math.nan


def _by_case(points: Sequence[Point]) -> dict[str, list[Point]]:
    cases: dict[str, list[Point]] = {}
    for point in points:
        cases.setdefault(point.case, []).append(point)
    return cases


def _ms(seconds: float) -> str:
    return _digits(1e3 * seconds)


def _digits(value: float) -> str:
    """Three digits, without an exponent."""
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"
