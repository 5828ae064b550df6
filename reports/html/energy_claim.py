"""The section on the paper's energy claim: its charts, and its worst figures in words."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache

from reports.furnace import MASKINGS, Departure, EnergyClaim, Masking, Quantity, energy_claim
from reports.html.charts import Axis, Chart, Line, line_chart

WEIGHT = 0.5  # of the charts over angle and roughness: the mixture's own departure is worst there


@dataclass(frozen=True)
class Kind:
    """One row of charts: what it measures, the label and range (%) of its y axis."""

    name: Quantity
    heading: str
    y_title: str
    y_range: tuple[float, float]


KINDS = (
    Kind("weak", "Weak furnace", "facets seen (%)", (88, 102)),
    Kind("albedo", "Mirror lobe", "light sent back (%)", (20, 101)),
    Kind("surface", "White surface", "light sent back (%)", (80, 180)),
)


@dataclass(frozen=True)
class ClaimView:
    """What the section's template shows."""

    claim: EnergyClaim
    typical: Departure
    charts: list[list[Chart]]


@cache  # it is the same for every run
def energy_claim_view() -> ClaimView:
    """The claim, its figure at the paper's own example (its Fig. 5, roughness .5), its charts."""
    claim = energy_claim()
    half = float(_curve(claim, "weak", "paper", 0.5, 80.0, WEIGHT)[0])
    return ClaimView(
        claim=claim,
        typical=Departure(half / 100, 0.5, 80.0, WEIGHT),
        charts=[list(_charts(claim, kind)) for kind in KINDS],
    )


def _charts(claim: EnergyClaim, kind: Kind) -> Iterable[Chart]:
    """One quantity over weight, angle and roughness."""
    at = f"weight {WEIGHT:g}"
    places = ((0.2, 80.0), (0.5, 80.0), (1.0, 89.0))
    yield _chart(
        claim, kind, "over weight",
        "weight", claim.weights, (0, 0.25, 0.5, 0.75, 1),
        "roughness, angle", {f"{r:g}, {a:g}°": (r, a, None) for r, a in places},
    )  # fmt: skip
    yield _chart(
        claim, kind, f"over angle, {at}",
        "angle from the normal (degrees)", claim.angles, (0, 15, 30, 45, 60, 75, 89),
        "roughness", {f"{r:g}": (r, None, WEIGHT) for r in (0.1, 0.5, 1.0)},
    )  # fmt: skip
    yield _chart(
        claim, kind, f"over roughness, {at}",
        "roughness", claim.roughness, (0.1, 0.4, 0.7, 1),
        "angle", {f"{a:g}°": (None, a, WEIGHT) for a in (45.0, 80.0, 89.0)},
    )  # fmt: skip


def _chart(
    claim: EnergyClaim,
    kind: Kind,
    over: str,
    x_title: str,
    x: Sequence[float],
    ticks: Sequence[float],
    series_title: str,
    series: dict[str, tuple[float | None, float | None, float | None]],
) -> Chart:
    lines = [
        Line(label, masking, _curve(claim, kind.name, masking, *place))
        for masking in MASKINGS
        for label, place in series.items()
    ]
    ends = {m: [y for line in lines if line.style == m for y in line.y] for m in MASKINGS}
    spans = (f"{m} from {min(ys):.1f} to {max(ys):.1f} %" for m, ys in ends.items())
    return line_chart(
        f"{kind.heading} {over}",
        f"{kind.y_title}, masking {' and '.join(spans)}.",
        Axis(x_title, (ticks[0], ticks[-1]), ticks),
        Axis(kind.y_title, kind.y_range),
        x,
        lines,
        series_title=series_title,
        told=lambda y: f"{y:.1f} %",
    )


def _curve(
    claim: EnergyClaim,
    quantity: Quantity,
    masking: Masking,
    roughness: float | None,
    angle: float | None,
    weight: float | None,
) -> list[float]:
    """Percentages along whichever of the three is None."""
    axes = ((claim.roughness, roughness), (claim.angles, angle), (claim.weights, weight))
    place = tuple(slice(None) if at is None else axis.index(at) for axis, at in axes)
    return [float(y) for y in 100 * claim.figures[quantity, masking][place].reshape(-1)]
