"""Limits of detection and false alarms to what the template shows."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from reports.html.attack.words import plainly
from reports.html.charts import SERIES_COLOURS, Axis, Chart, Line, line_chart
from reports.html.figures import GAP, NONE, digits, percent, seconds
from reports.html.logaxis import LogAxis
from reports.html.trust import Fact, versions_of
from reports.limits.results import EVERY, FalseAlarms, Limit, Limits

WHOLE = "whole suite"
SIGNS = {"+": "plus", "-": "minus"}
BY = {"budget": "the budget", "noise": "the reference's noise"}


@dataclass(frozen=True)
class SideView:
    """The limit of one sign of an error, as text; `state` is "never" where it is out of reach."""

    smallest: str
    ends: str
    state: str


@dataclass(frozen=True)
class LimitView:
    """One kind of error, judged by one technique's rows or (`technique` is "") the whole suite's.

    `plus` and `minus` are None where that sign was not tried. `why` tells for each sign, or with an
    empty sign for both, what hides a smaller error and which row sees it first.
    """

    parameter: str
    technique: str
    plus: SideView | None
    minus: SideView | None
    noiseless: str
    by: str
    why: list[tuple[str, str, str]]


@dataclass(frozen=True)
class LimitsView:
    """The whole section; `limits` and `charts` of the whole suite, then technique by technique."""

    sentence: str
    limits: list[LimitView]
    single: list[LimitView]
    charts: list[Chart]
    alarms: list[tuple[FalseAlarms, str]]
    state: str
    facts: list[Fact]
    command: str


def limits_view(found: Limits) -> LimitsView:
    """Everything that the section shows."""
    whole = [x for x in found.limits if x.technique == EVERY] or found.limits
    return LimitsView(
        sentence=_sentence(found.false_alarms),
        limits=_rows(whole),
        single=_rows([x for x in found.limits if x not in whole]),
        charts=_charts(found.limits),
        alarms=[(a, _interval(a)) for a in found.false_alarms],
        state="fail" if any(a.alarms for a in found.false_alarms) else "pass",
        facts=[
            Fact("Judged by", f"the gate, on the suite {found.suite}"),
            Fact("Batches", f"drawn without replacement from {found.pool} of each reference"),
            Fact("Measured", f"{found.created}, in {seconds(found.seconds)}"),
            Fact("Versions", versions_of(found.provenance)),
        ],
        command=found.command,
    )


def size(value: float | None, unit: str, signed: str = "") -> str:
    """The size of an error with its unit; a dash where there is none."""
    if value is None or math.isnan(value):
        return NONE
    if unit == "relative":
        return f"{signed}{digits(100 * value)}{GAP}%"
    return f"{signed}{digits(value)}{'°' if unit == 'degrees' else ''}"


def _rows(limits: Sequence[Limit]) -> list[LimitView]:
    """A row for each parameter and technique, with both signs."""
    groups: dict[tuple[str, str], list[Limit]] = {}
    for found in limits:
        groups.setdefault((found.technique, found.parameter), []).append(found)
    return [_row(own) for own in groups.values()]


def _row(own: Sequence[Limit]) -> LimitView:
    sides = {found.sign: _side(found) for found in own}
    first, kinds = own[0], dict.fromkeys(found.limited_by for found in own)
    by = BY[first.limited_by]
    if len(kinds) > 1:
        by = ", ".join(f"{SIGNS[found.sign]}: {BY[found.limited_by]}" for found in own)
    return LimitView(
        parameter=first.parameter,
        technique="" if first.technique == EVERY else first.technique,
        plus=sides.get("+"),
        minus=sides.get("-"),
        noiseless=", ".join(size(found.noiseless, found.unit, _sign(found)) for found in own),
        by=by,
        why=_why(own),
    )


def _why(own: Sequence[Limit]) -> list[tuple[str, str, str]]:
    """What is said of each sign, once where it is the same."""
    said = [(SIGNS[found.sign], plainly(found.words), plainly(found.seen_by)) for found in own]
    alike = len({about[1:] for about in said}) == 1
    return [("", *said[0][1:])] if alike else said


def _side(found: Limit) -> SideView:
    most = max((p.size for p in found.curve), default=math.nan)
    shown = size(most if found.smallest is None else found.smallest, found.unit, _sign(found))
    if found.smallest is None:
        return SideView(f"not even {shown}" if most == most else "not measured", "", "never")
    low, high = size(found.low, found.unit), size(found.high, found.unit)
    ends = f"{low} to {high}"
    if found.high is None:
        ends = "" if found.low is None else f"{low} or more"
    elif found.low is None:
        ends = f"{high} or less"
    return SideView(shown, ends, "")


def _sign(found: Limit) -> str:
    return "+" if found.sign == "+" else "−"


def _sentence(alarms: Sequence[FalseAlarms]) -> str:
    if not alarms:
        return "False alarms were not measured"
    cried = [f"{a.alarms} in {a.sets} judgements of {a.what}" for a in alarms if a.alarms]
    if cried:
        return f"False alarms: {', '.join(cried)}"
    worst = max(alarms, key=lambda a: a.high)
    return (
        f"No false alarms in {sum(a.sets for a in alarms)} judgements of what is right "
        f"(95 % interval: up to {percent(worst.high)} of those of {worst.what})"
    )


def _interval(alarms: FalseAlarms) -> str:
    return f"{percent(alarms.low)} to {percent(alarms.high)}"


def _charts(limits: Sequence[Limit]) -> list[Chart]:
    """By parameter, the share that is caught over the size of the error."""
    groups: dict[str, list[Limit]] = {}
    for found in limits:
        if found.curve:
            groups.setdefault(found.parameter, []).append(found)
    return [_chart(group) for group in groups.values()]


def _chart(group: Sequence[Limit]) -> Chart:
    """A line for each technique and sign, of as many techniques as there are colours."""
    group = sorted(group, key=lambda found: found.technique != EVERY)
    techniques = list(dict.fromkeys(found.technique for found in group))[: len(SERIES_COLOURS)]
    group = [found for found in group if found.technique in techniques]
    unit = group[0].unit
    x = sorted({p.size for found in group for p in found.curve})
    lines = []
    for found in group:
        at = {p.size: 100 * p.caught / p.of for p in found.curve if p.of}
        name = WHOLE if found.technique == EVERY else found.technique
        lines.append(Line(name, SIGNS[found.sign], [at.get(s, math.nan) for s in x]))
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
