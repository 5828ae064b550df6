"""The strip of trust: why the figures can be believed, and where they cannot."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any

from reports.candidates import OUTSIDE
from reports.html.figures import GAP, METRICS, NONE, half_width, percent, similarity
from reports.html.verdict import against
from reports.results import Results, Row

NEAR_BLACK = 5.0  # times the light of a block: from there on the truth, not the picture, is why


@dataclass(frozen=True)
class Fact:
    """One entry of the strip; `doubt` marks one that a reader has to look at."""

    term: str
    text: str
    doubt: bool = False
    detail: tuple[str, ...] = ()


def facts(results: Results) -> list[Fact]:
    """What the run says of itself, in the order in which doubts should be raised."""
    device = results.provenance.get("device")  # of our own renderer, where it drew
    return [
        _conformance(results),
        Fact("Reference noise, 95 %, in the median and worst row", _noise(results)),
        _rows(results),
        *_references(results),
        *([Fact("Device", str(device))] if device else []),
        Fact("Versions", versions_of(results.provenance)),
    ]


def drawn_here(rows: list[Row]) -> bool:
    """Whether our own renderer drew any of some rows, or there are none."""
    return not rows or any(r.technique != OUTSIDE for r in rows)


def _conformance(results: Results) -> Fact:
    checks = results.provenance.get("parity") or []
    if not checks:
        own = drawn_here(results.rows)
        told = "not checked in this run" if own else "none is asked of a candidate from outside"
        return Fact("Conformance", told, doubt=own)
    failed = [c for c in checks if not c["passed"]]
    text = f"{len(checks) - len(failed)} of {len(checks)} checks pass"
    if failed:
        text += f"; {', '.join(c['name'] for c in failed)} does not"
    order = sorted(checks, key=lambda c: c["passed"])
    marks = (f"{'passes' if c['passed'] else 'FAILS'}: {c['name']}, {c['detail']}" for c in order)
    return Fact("Conformance", text, bool(failed), tuple(marks))


def _noise(results: Results) -> str:
    named: tuple[tuple[str, str, Callable[[float], str]], ...] = (
        ("energy_local", "local energy", percent),
        ("energy_error", "total energy", percent),
        ("ssim", "SSIM", similarity),
    )
    if all(math.isnan(METRICS[name].value(r)) for name, _, _ in named for r in results.rows):
        return "no row has figures"
    parts = []
    for name, label, show in named:
        halves = [half_width(METRICS[name].bounds(r)) for r in results.rows]
        halves = [h for h in halves if math.isfinite(h)]
        reasons = [why for r in results.rows if (why := METRICS[name].hidden(r))]
        if halves:
            unknown = f"; unknown in {len(reasons)}" if reasons else ""
            figures = f"±{GAP}{show(median(halves))}, ±{GAP}{show(max(halves))}"
            parts.append(f"{label} {figures}{_worst(name, results.rows)}{unknown}")
        elif reasons:
            parts.append(f"{label} unknown: {reasons[0]}")
    return "\n".join(parts) or NONE


def _worst(name: str, rows: list[Row]) -> str:
    """Which row is the noisiest, and why if its figure tells; nothing of a single row."""
    known = [r for r in rows if math.isfinite(half_width(METRICS[name].bounds(r)))]
    if len(known) < 2:
        return ""
    row = max(known, key=lambda r: half_width(METRICS[name].bounds(r)))
    told = f"{row.object} in {row.case}, {against(row)}"
    # Blocks are held against the truth's own light in them, and so is their noise.
    if name == "energy_local" and row.energy_local > NEAR_BLACK:
        told += f": {percent(row.energy_local)} off, its truth has near-black blocks"
    return f" ({told})"


def _rows(results: Results) -> Fact:
    broken, skipped = sum(bool(r.problem) for r in results.rows), len(results.skipped)
    text = (
        f"{len(results.rows)} of {results.expected_rows}; {len(results.missing)} missing, "
        f"{broken} without figures, {skipped} case{'s' * (skipped != 1)} skipped"
    )
    doubt = bool(results.missing or broken or results.skipped)
    missing = (
        f"missing: {m.case}, {m.object}, {m.technique} vs {m.truth}" for m in results.missing
    )
    return Fact("Rows", text, doubt, (*missing, *(f"skipped: {s}" for s in results.skipped)))


def _references(results: Results) -> list[Fact]:
    """Whose references these are; nothing where the run does not tell."""
    if not (makers := results.provenance.get("references")):
        return []
    others = [m for m in makers if not m["ours"]]
    text = "made by other code: blessed" if others else "made by this code"
    told = (
        f"{'this' if m['ours'] else 'other'}: code {m['code']}, Mitsuba {m['mitsuba']}, "
        f"Dr.Jit {m['drjit']}"
        for m in sorted(makers, key=lambda m: m["ours"])
    )
    return [Fact("References", text, bool(others), tuple(told))]


def versions_of(provenance: dict[str, Any]) -> str:
    """The versions of the packages that a run names."""
    versions = provenance.get("versions")
    if not isinstance(versions, dict):
        return NONE
    return ", ".join(f"{name} {version}" for name, version in versions.items())
