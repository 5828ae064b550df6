"""A bench to what the template shows: a tree of plain records."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from reports.html.charts import Chart
from reports.html.figures import NONE, percent, seconds, slug
from reports.html.speed import words
from reports.html.speed.growth import growth_charts, lobe_charts
from reports.html.speed.scatter import FAMILIES, Mode, Plot, modes_of, plots
from reports.html.speed.table import PointTable, point_table
from reports.html.trust import Fact, versions_of
from reports.speed.points import Bench, Error, LeftOut, Point

FEW = 8  # techniques, of which each is told of in a sentence


@dataclass(frozen=True)
class PlotView:
    """A plot, and what it says of each technique, the fastest first.

    `first` is that of the technique that the suite names first, if it is on the plot. Where there
    are many techniques, `others` are those off the front.
    """

    plot: Plot
    first: list[tuple[str, str]]
    told: list[tuple[str, str]]
    others: list[tuple[str, str]]


@dataclass(frozen=True)
class ObjectView:
    """One object of a case."""

    name: str
    surface: str
    plots: list[PlotView]


@dataclass(frozen=True)
class LeftOutView:
    """One thing that a case does without, as text."""

    what: str
    why: str
    kind: str
    difference: str
    saved: str


@dataclass(frozen=True)
class CaseView:
    """One case."""

    id: str
    name: str
    place: str
    objects: list[ObjectView]
    table: PointTable
    left_out: list[LeftOutView]


@dataclass(frozen=True)
class SpeedView:
    """The whole section."""

    headline: str
    rate: str
    modes: list[Mode]
    families: tuple[str, ...]
    cases: list[CaseView]
    growths: list[tuple[Chart, list[Markup]]]
    lobes: dict[str, list[Chart]]
    skipped: list[str]
    facts: list[Fact]
    command: str
    provenance: str


def speed_view(bench: Bench) -> SpeedView:
    """Everything that the section shows."""
    modes = modes_of(bench)
    cases: dict[str, list[Point]] = {}
    for point in bench.points:
        cases.setdefault(point.case, []).append(point)
    return SpeedView(
        headline=words.headline(bench),
        rate=words.paper_rate(bench),
        modes=modes,
        families=tuple(f for f in FAMILIES if any(p.family == f for p in bench.points)),
        cases=[_case(points, bench, modes) for points in cases.values()],
        growths=[
            (c, [words.growth(g) for g in found]) for c, found in growth_charts(bench.growths)
        ],
        lobes=lobe_charts(bench.lobes),
        skipped=bench.skipped,
        facts=[
            Fact("Device", words.device_of(bench)),
            Fact("Machine", str(bench.provenance.get("machine", NONE))),
            Fact("Versions", versions_of(bench.provenance)),
            Fact("Measured", f"{bench.created}, in {seconds(bench.seconds)}"),
        ],
        command=bench.command,
        provenance=json.dumps(bench.provenance, indent=2, ensure_ascii=False, default=str),
    )


def _case(points: Sequence[Point], bench: Bench, modes: Sequence[Mode]) -> CaseView:
    first = points[0]
    errors = {e.object: e for p in points for e in p.errors}
    return CaseView(
        id=slug("speed", first.case),
        name=first.case,
        place=f"{first.environment}, {first.width}×{first.height}",
        objects=[_object(e, points, bench, modes) for e in errors.values()],
        table=point_table(points, list(errors)),
        left_out=[_left_out(x) for x in bench.left_out if x.case == first.case],
    )


def _object(
    error: Error, points: Sequence[Point], bench: Bench, modes: Sequence[Mode]
) -> ObjectView:
    drawn = plots(points, error.object, modes)
    return ObjectView(
        name=error.object,
        surface=f"{error.material}, roughness {error.roughness:g}, weight {error.weight:g}",
        plots=[_plot(plot, error.object, bench) for plot in drawn],
    )


def _plot(plot: Plot, object_name: str, bench: Bench) -> PlotView:
    real = [s for s in plot.spots if s.point.family == "real-time" and "warm" in s.states]
    first = [s.point.name for s in real[:1]]
    shown = {s.point.name for s in real if len(real) <= FEW or s.states["warm"].standing == "front"}
    real.sort(key=lambda s: s.point.frame.median)
    told = {
        s.point.name: words.verdict_of(s.point, object_name, plot.quantity, bench) for s in real
    }
    return PlotView(
        plot,
        first=[(n, told[n]) for n in first],
        told=[(n, said) for n, said in told.items() if n in shown and n not in first],
        others=[(n, said) for n, said in told.items() if n not in shown and n not in first],
    )


def _left_out(found: LeftOut) -> LeftOutView:
    if not math.isfinite(found.difference):
        difference = NONE
    elif found.exact and found.difference == 0:
        difference = "nothing"
    elif found.exact or not math.isfinite(found.interval):
        difference = f"the frame by relMSE {found.difference:.1e}".replace("e-0", "e-").replace(
            "-", "−"
        )
    else:
        difference = f"the truth by {percent(found.difference)}"
        difference += f", known within {percent(found.interval)}"
    saved = seconds(found.saved_seconds)
    if math.isfinite(found.saved_low) and math.isfinite(found.saved_high):
        saved += f" ({seconds(found.saved_low)} to {seconds(found.saved_high)})"
    return LeftOutView(
        what=found.what,
        why=found.why,
        kind="exact" if found.exact else "approximate",
        difference=difference,
        saved=saved,
    )
