"""A run of `shadeproof stability` to what the template shows: what misses its limit first."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass

from reports.html.figures import NONE, seconds, slug
from reports.html.numbers import departure, figure, input_value, name
from reports.html.stability.maps import MapView, map_views
from reports.html.stability.scale import scale_of
from reports.html.trust import Fact, versions_of
from reports.stability.promise import HARD_HOLDS
from reports.stability.results import HardCase, Map, Promise, Stability

FIRST = ("brdf", "against float64")  # the map to look at where none is over its limit
KINDS = {
    "function": "Functions", "material": "Materials", "environment": "Environments",
    "mesh": "Meshes", "image": "Images",
}  # fmt: skip


@dataclass(frozen=True)
class PromiseView:
    """A promise in words."""

    promise: Promise
    where: str
    told: str


@dataclass(frozen=True)
class FunctionView:
    """The maps of one function; `open` are the ids of those that are unfolded."""

    name: str
    id: str
    told: str
    open: set[str]
    maps: list[MapView]


@dataclass(frozen=True)
class CaseView:
    """A hard case."""

    case: HardCase
    id: str
    measured: list[tuple[str, str]]


@dataclass(frozen=True)
class StabilityView:
    """The whole section; `summary` are the maps, what comes closest to its limit first."""

    headline: str
    state: str
    promises: list[PromiseView]
    summary: list[MapView]
    functions: list[FunctionView]
    kinds: list[tuple[str, str, list[CaseView]]]
    facts: list[Fact]
    command: str
    provenance: str


def stability_view(found: Stability) -> StabilityView:
    """Everything that the section shows."""
    summary = map_views(sorted(found.maps, key=_urgency))
    return StabilityView(
        headline=headline(found),
        state="pass" if found.passed else "fail",
        promises=[_promise(p, len(found.hard)) for p in sorted(found.domain, key=lambda p: p.held)],
        summary=summary,
        functions=_functions(summary),
        kinds=_kinds(found.hard),
        facts=[
            Fact("Device", str(found.provenance.get("device", NONE))),
            Fact("Machine", str(found.provenance.get("machine", NONE))),
            Fact("Versions", versions_of(found.provenance)),
            Fact("Measured", f"{found.created}, in {seconds(found.seconds)}"),
        ],
        command=found.command,
        provenance=json.dumps(found.provenance, indent=2, ensure_ascii=False, default=str),
    )


def headline(found: Stability) -> str:
    """What holds, or how much does not and what is worst."""
    judged = [m for m in found.maps if m.limit is not None]
    totals = _count(len(judged), "limit"), _count(len(found.hard), "hard case")
    if found.passed:
        if not judged and not found.hard:
            return "Nothing was tried"
        return f"The shaders keep every promise: {totals[0]} and {totals[1]} hold"
    missed = [m for m in sorted(judged, key=_urgency) if not m.passed]
    broken = [c for c in found.hard if not c.passed]
    broken_promises = sum(not p.held for p in found.domain)
    parts = []
    if missed:
        parts.append(f"{len(missed)} of {totals[0]} missed")
    if broken:
        parts.append(f"{len(broken)} of {totals[1]} broken")
    if broken_promises:
        parts.append(f"{broken_promises} of {_count(len(found.domain), 'promise')} not kept")
    told = f"The shaders break a promise: {', '.join(parts)}"
    if missed:
        worst = missed[0]
        told += (
            f"; the worst is {worst.function}, {worst.invariant}: "
            f"{figure(worst.worst.value)} where {figure(worst.limit)} is allowed"
        )
    return told


def _urgency(found: Map) -> tuple[bool, bool, float]:
    """Sorts what misses its limit first, what has none last, and else by how near it comes."""
    value = found.worst.value if math.isfinite(found.worst.value) else math.inf
    if found.limit is None:
        return found.passed, True, -value
    off = scale_of([(found.at_least, found.limit)]).off
    return found.passed, False, -off(value) / (off(found.limit) or 1)


def _promise(promise: Promise, hard: int) -> PromiseView:
    bounds = (
        f"{name(n)} {input_value(low)} to {input_value(high)}"
        for n, (low, high) in promise.bounds.items()
    )
    if promise.claim == HARD_HOLDS:
        told = f"{hard - int(promise.worst)} of {hard}"
    else:
        allowed = "" if promise.limit is None else f", {departure(promise.limit)} allowed"
        told = f"worst {departure(promise.worst)}{allowed}"
    return PromiseView(promise, ", ".join(bounds), told)


def _functions(views: Sequence[MapView]) -> list[FunctionView]:
    """By function, in the order of the summary; what is over its limit is unfolded, and one map."""
    shown = next((v for v in views if (v.map.function, v.map.invariant) == FIRST), None)
    groups: dict[str, list[MapView]] = {}
    for view in views:
        groups.setdefault(view.map.function, []).append(view)
    found = []
    for function, own in groups.items():
        missed = sum(v.over for v in own)
        told = _count(len(own), "map") + (f", {missed} over the limit" if missed else "")
        unfolded = {v.id for v in own if v.over or v is shown}
        own = sorted(own, key=lambda v: v.id not in unfolded)
        found.append(FunctionView(function, slug("atlas", function), told, unfolded, own))
    return sorted(found, key=lambda f: not f.open)


def _kinds(cases: Sequence[HardCase]) -> list[tuple[str, str, list[CaseView]]]:
    """By kind, what broke first."""
    found = []
    for kind, title in KINDS.items():
        own = [_case(c) for c in sorted(cases, key=lambda c: c.passed) if c.kind == kind]
        if own:
            held = sum(c.case.passed for c in own)
            found.append((title, f"{held} of {len(own)} hold", own))
    return found


def _case(case: HardCase) -> CaseView:
    measured = [(words, departure(value)) for words, value in case.measured.items()]
    return CaseView(case, slug("hard", case.kind, case.name), measured)


def _count(number: int, thing: str) -> str:
    return f"{number} {thing}{'s' * (number != 1)}"
