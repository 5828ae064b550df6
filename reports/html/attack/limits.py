"""Limits of detection and false alarms to what the template shows."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from reports.attack.limits import EVERY, FalseAlarms, Limit, Limits
from reports.html.charts import SERIES_COLOURS, Axis, Chart, Line, line_chart
from reports.html.figures import GAP, NONE, digits, percent, seconds
from reports.html.logaxis import LogAxis
from reports.html.trust import Fact, versions_of

WHOLE = "whole suite"
SIGNS = {"+": "too large", "-": "too small"}


@dataclass(frozen=True)
class LimitView:
    """One limit as text."""

    limit: Limit
    what: str
    technique: str
    smallest: str
    ends: str
    noiseless: str
    by: str


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
        limits=[_limit(x) for x in whole],
        single=[_limit(x) for x in found.limits if x not in whole],
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


def _limit(found: Limit) -> LimitView:
    sign = "+" if found.sign == "+" else "−"
    most = max((p.size for p in found.curve), default=math.nan)
    if found.smallest is None:
        smallest = f"not even {size(most, found.unit, sign)}" if most == most else "not measured"
    else:
        smallest = size(found.smallest, found.unit, sign)
    ends = [size(v, found.unit) for v in (found.low, found.high)]
    open_ended = found.high is None and found.low is not None
    told = f"{ends[0]} or more" if open_ended else f"{ends[0]} to {ends[1]}"
    return LimitView(
        limit=found,
        what=f"{found.parameter} {SIGNS[found.sign]}",
        technique="" if found.technique == EVERY else found.technique,
        smallest=smallest,
        ends="" if found.low is None and found.high is None else told,
        noiseless=size(found.noiseless, found.unit, sign),
        by={"budget": "the budget", "noise": "the reference's noise"}[found.limited_by],
    )


def _sentence(alarms: Sequence[FalseAlarms]) -> str:
    if not alarms:
        return "False alarms were not measured"
    cried, sets = sum(a.alarms for a in alarms), sum(a.sets for a in alarms)
    worst = max(a.high for a in alarms)
    return (
        f"{cried or 'No'} false alarm{'s' * (cried != 1)} in {sets} judgements of a right renderer "
        f"(95 % interval: up to {percent(worst)} of them)"
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
