"""Results to what the template shows: a tree of plain records, worst first."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reports.frames import CaseFrames
from reports.gate import headline, worst_first
from reports.html import causes, columns, verdict
from reports.html.attack import GateView, gate_of
from reports.html.changed import ChangedView, changed_of
from reports.html.colour import ERROR, SIGNED, SIMILARITY, Scale
from reports.html.energy_claim import ClaimView, energy_claim_view
from reports.html.figures import METRICS, decisive, seconds, slug
from reports.html.finder import Finder, finder_of
from reports.html.gains import Gains, gains_of
from reports.html.images import Picture, cause_maps, close_ups
from reports.html.layers import Layer, case_layers
from reports.html.matrix import Matrix, label_of, matrices, row_id
from reports.html.speed import SpeedView, speed_of
from reports.html.stability import StabilityView, stability_of
from reports.html.trend import Trend, trends_of
from reports.html.trust import Fact, drawn_here, facts
from reports.html.weights import WeightChart, weight_charts
from reports.ladder import NAMES
from reports.results import CaseRecord, Results, Row
from reports.telling import again, notes_of

VERDICTS = ("fail", "inconclusive", "pass", "reported")


@dataclass(frozen=True)
class Kind:
    """A kind of picture: its title, how to read it, and the scale of its colours."""

    title: str
    reading: str
    scale: Scale | None = None


KINDS = {
    "candidate": Kind(
        "Candidate",
        "What the real-time technique draws; if it has switches for what the reference leaves "
        "out, with these off.",
    ),
    "truth": Kind("Reference", "What path tracing gives, at the same exposure."),
    "signed": Kind(
        "Signed error",
        "Per pixel, candidate over reference, minus 1. Red is too bright, blue too dark, white "
        "right. Fine grain is the reference's noise; smooth patches are errors.",
        SIGNED,
    ),
    "blocks": Kind(
        "Block energy error",
        "Light of 16×16 pixels, candidate over reference, minus 1: noise averages out. Red is too "
        "bright, blue too dark. Local energy is the root mean "
        "square of these blocks: it cannot be passed by being too bright here and too dark there.",
        SIGNED,
    ),
    "ssim": Kind(
        "SSIM",
        "How alike the structure is around each pixel: yellow is the same. Dark spots are where "
        "highlights, edges or texture differ, whatever the energy says.",
        SIMILARITY,
    ),
    "flip": Kind(
        "FLIP",
        "How different two pictures look that are flipped back and forth (HDR-FLIP, at two "
        "exposures): black is the same. The reference's noise counts as difference.",
        ERROR,
    ),
    "difference": Kind(
        "Difference",
        "Size of the difference of linear radiance, channel by channel, at the chosen exposure: "
        "black is the same.",
    ),
    **{n: Kind(f"Error by {n}", causes.MEANINGS[n], SIGNED) for n in NAMES},
}

# What the viewer can show: its name in an address, its label, and the kind that explains it.
VIEWS = {
    "slide": ("slider", Kind("", "Left of the divider the candidate, right of it the reference.")),
    "blink": ("flip", Kind("", "One in the other's place: what jumps is the difference.")),
    "side": ("side by side", Kind("", "Zoom and place are the same on both sides.")),
    "difference": ("difference", KINDS["difference"]),
    "signed": ("signed error", KINDS["signed"]),
    "blocks": ("block error", KINDS["blocks"]),
    "ssim": ("SSIM", KINDS["ssim"]),
    "flip": ("FLIP", KINDS["flip"]),
}


@dataclass(frozen=True)
class RowView:
    """A row in a case's table."""

    id: str
    row: Row
    material: str
    note: str
    cells: list[columns.Shown]


@dataclass(frozen=True)
class CaseView:
    """A case with its pictures and rows; `chosen` is the technique and truth shown first.

    `notes` are what all rows note, `command` shows it again.
    """

    id: str
    record: CaseRecord
    counts: str
    verdict: str
    techniques: list[str]
    truths: list[str]
    chosen: tuple[str, str]
    layers: list[Layer]
    viewer: dict[str, Any]
    causes: list[causes.Chart]
    part_meanings: dict[str, str]
    cause_maps: list[Picture]
    rows: list[RowView]
    trends: list[Trend]
    notes: list[str]
    missing: list[str]
    command: str


@dataclass(frozen=True)
class Page:
    """All that the template shows."""

    results: Results
    headline: str
    sentence: str
    caution: str
    counts: str
    worst: Row | None
    worst_id: str
    close_ups: list[Picture]
    techniques: list[str]
    truths: list[str]
    chosen: tuple[str, str]
    energy: str
    matrices: list[Matrix]
    labels: dict[str, str]
    gains: Gains | None
    weights: list[WeightChart]
    facts: list[Fact]
    changed: ChangedView | None
    finder: Finder
    cases: list[CaseView]
    forgotten: str
    groups: tuple[tuple[str, tuple[columns.Column, ...]], ...]
    kinds: dict[str, Kind]
    provenance: str
    seconds: str
    budgets: list[list[str]]
    energy_claim: ClaimView | None
    speed: SpeedView | str | None
    stability: StabilityView | str | None
    gate: GateView | None

    @property
    def layers(self) -> list[Layer]:
        """What the viewers draw, of all cases."""
        return [layer for case in self.cases for layer in case.layers if layer.data]

    @property
    def views(self) -> list[tuple[str, str]]:
        """The views of a case: their names in an address, and their labels."""
        return [(name, label) for name, (label, _) in VIEWS.items()]

    @property
    def readings(self) -> list[tuple[str, Kind]]:
        """How to read each view."""
        return [(name, kind) for name, (_, kind) in VIEWS.items()]

    @property
    def told_kinds(self) -> dict[str, Any]:
        """Of each kind what the page's script needs: its title and its colours."""
        return {name: _told(kind) for name, kind in KINDS.items()}


def _told(kind: Kind) -> dict[str, Any]:
    told: dict[str, Any] = {"title": kind.title}
    if scale := kind.scale:
        told |= {"low": scale.low, "high": scale.high, "palette": scale.palette}
    return told


def page_of(results: Results, folder: Path) -> Page:
    """Everything on the page; reads the frames that lie in `folder`."""
    ranked = worst_first(results.rows)
    worst = ranked[0] if ranked else None
    order = {case: i for i, case in reversed(list(enumerate(r.case for r in ranked)))}
    records = sorted(results.cases, key=lambda c: order.get(c.id, len(ranked)))
    # Frames are dropped case by case: those of a whole suite may not fit into memory.
    trends, forgotten = trends_of(folder, results.suite)
    views = [
        _case(results, CaseFrames(c, folder, _of(ranked, c)), trends.get(c.id, [])) for c in records
    ]
    place = next((c for c in records if worst and c.id == worst.case), None)
    return Page(
        results=results,
        headline=headline(results),
        sentence=verdict.sentence(results, ranked),
        caution=verdict.caution(results),
        counts=_counts(results.rows),
        worst=worst,
        worst_id=row_id(worst) if worst else "",
        close_ups=_close_ups(place, folder, ranked),
        techniques=list(dict.fromkeys(r.technique for r in results.rows)),
        truths=list(dict.fromkeys(r.truth for r in results.rows)),
        chosen=(worst.technique, worst.truth) if worst else ("", ""),
        energy="total" if worst and decisive(worst) == "energy_error" else "local",
        matrices=matrices(results.rows),
        labels={name: metric.label for name, metric in METRICS.items()},
        gains=gains_of(results.rows),
        weights=weight_charts(results.rows),
        facts=facts(results),
        changed=changed_of(results),
        finder=finder_of(results.rows),
        cases=views,
        forgotten=forgotten,
        groups=columns.GROUPS,
        kinds=KINDS,
        provenance=json.dumps(results.provenance, indent=2, ensure_ascii=False, default=str),
        seconds=seconds(results.seconds),
        budgets=[
            [
                f"{name} {value}"
                for name, value in b.model_dump(exclude_none=True).items()
                if value != ""
            ]
            for b in results.budgets
        ],
        # What the paper's mixtures do is nothing to a renderer from outside.
        energy_claim=energy_claim_view() if drawn_here(results.rows) else None,
        speed=speed_of(folder),
        stability=stability_of(folder),
        gate=gate_of(folder),
    )


def _of(rows: list[Row], record: CaseRecord) -> list[Row]:
    return [r for r in rows if r.case == record.id]


def _close_ups(place: CaseRecord | None, folder: Path, ranked: list[Row]) -> list[Picture]:
    """Those of the worst row, if the run recorded its case."""
    if place is None:
        return []
    return close_ups(CaseFrames(place, folder, _of(ranked, place)), ranked[0])


def _case(results: Results, frames: CaseFrames, trends: list[Trend]) -> CaseView:
    record, rows = frames.record, frames.rows
    layers = case_layers(frames)
    ladders = [found for found in results.ladders if found.case == record.id]
    shown = causes.charts(ladders)
    shared, own = notes_of(rows)
    drawn, traced = ([p for p in layers if p.kind == kind] for kind in ("candidate", "truth"))
    techniques = list(dict.fromkeys(t for p in drawn for t in p.techniques))
    truths = list(dict.fromkeys(t for p in traced for t in p.truths))
    chosen = (rows[0].technique, rows[0].truth) if rows else (
        next(iter(techniques), ""), next(iter(truths), "")
    )  # fmt: skip
    return CaseView(
        id=slug("case", record.id),
        record=record,
        counts=_counts(rows),
        verdict=rows[0].verdict if rows else "fail",
        techniques=techniques,
        truths=truths,
        chosen=chosen,
        layers=layers,
        viewer={
            "width": record.width,
            "height": record.height,
            "exposure": frames.exposure,
            "objects": list(dict.fromkeys(r.object for r in rows)),
            "layers": [layer.told for layer in layers],
        },
        causes=shown,
        part_meanings=causes.part_meanings(shown),
        cause_maps=cause_maps(frames, ladders),
        rows=[_row(r, results.rows, note) for r, note in zip(rows, own, strict=True)],
        trends=trends,
        notes=shared,
        missing=[
            f"{m.object}, {m.technique} vs {m.truth}"
            for m in results.missing
            if m.case == record.id
        ],
        command=again(results, record.id, frames.folder),
    )


def _row(row: Row, rows: list[Row], note: str) -> RowView:
    return RowView(row_id(row), row, label_of(row, rows), note, columns.cells(row))


def _counts(rows: list[Row]) -> str:
    """How many rows of each verdict."""
    counts = ((sum(r.verdict == v for r in rows), v) for v in VERDICTS)
    return ", ".join(f"{n} {v}" for n, v in counts if n) or "no rows"
