"""Limits of detection and false alarms to what the template shows."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from scipy.stats import fisher_exact

from reports.html.attack.curves import SIGNS, Curves, Plot, curves, plots
from reports.html.attack.words import plainly
from reports.html.figures import GAP, NONE, count, digits, percent, seconds
from reports.html.trust import Fact, versions_of
from reports.limits.detection import share_interval
from reports.limits.results import EVERY, FalseAlarms, Limit, Limits


@dataclass(frozen=True)
class SideView:
    """The limit of one sign of an error, as text.

    `state` is "never" where it is out of reach, or where the figures tell of no one limit.
    """

    smallest: str
    ends: str
    state: str


@dataclass(frozen=True)
class AlarmView:
    """How often what is right ended the gate with 1: it failed a row, or could not decide one."""

    alarms: FalseAlarms
    ended: str
    share: str


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
    """The whole section; `limits` and `plots` of the whole suite, then technique by technique."""

    sentence: str
    limits: list[LimitView]
    single: list[LimitView]
    plots: list[Plot]
    curves: list[Curves]
    alarms: list[AlarmView]
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
        plots=plots(whole, _without_dot, size),
        curves=curves(found.limits, size),
        alarms=[_alarms(a) for a in found.false_alarms],
        state="fail" if any(map(_ended, found.false_alarms)) else "pass",
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
    by = first.limited_by
    if len(kinds) > 1:
        by = ", ".join(f"{_sign(found)} {found.limited_by}" for found in own)
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
    if why := contradiction(found):
        return SideView("no one limit", why, "never")
    low, high = size(found.low, found.unit), size(found.high, found.unit)
    ends = f"{low} to {high}"
    if found.high is None:
        ends = "" if found.low is None else f"{low} or more"
    elif found.low is None:
        ends = f"{high} or less"
    return SideView(shown, ends, "")


def _without_dot(found: Limit) -> str:
    side = _side(found)
    return side.smallest if side.state else ""


def contradiction(found: Limit) -> str:
    """What makes its figures tell of no one limit; empty where they do.

    That is a larger error that is caught less often, by more than the sets of batches explain
    (Fisher's exact test at 5 %), or a limit below the size from which a reference without noise
    would tell.
    """
    for less, more in pairwise(found.curve):
        missed = [[p.caught, p.of - p.caught] for p in (less, more)]
        if less.caught * more.of > more.caught * less.of and fisher_exact(missed).pvalue < 0.05:
            told = (f"{p.caught} of {p.of} at {size(p.size, found.unit)}" for p in (less, more))
            return f"caught {', but '.join(told)}"
    if None not in (found.smallest, found.noiseless) and found.smallest < found.noiseless:
        told, bare = (size(s, found.unit) for s in (found.smallest, found.noiseless))
        return f"caught from {told}, but without noise from {bare}"
    return ""


def _sign(found: Limit) -> str:
    return "+" if found.sign == "+" else "−"


def _sentence(alarms: Sequence[FalseAlarms]) -> str:
    if not alarms:
        return "False alarms were not measured"
    sets, cried = sum(a.sets for a in alarms), sum(a.alarms for a in alarms)
    if ended := sum(map(_ended, alarms)):
        return (
            f"The gate ends with 1 in {count(ended)} of {count(sets)} judgements of what is right: "
            f"{count(cried)} false alarm{'s' * (cried != 1)}, {count(ended - cried)} inconclusive"
        )
    worst = max(alarms, key=lambda a: a.high)
    return (
        f"No false alarms in {count(sets)} judgements of what is right "
        f"(95 % interval: up to {percent(worst.high)} of those of {worst.what})"
    )


def _alarms(found: FalseAlarms) -> AlarmView:
    ends = map(percent, share_interval(_ended(found), found.sets))
    return AlarmView(found, f"{_ended(found)} of {found.sets}", " to ".join(ends))


def _ended(found: FalseAlarms) -> int:
    """How often the gate ended with 1: what is inconclusive passes no more than what fails."""
    return found.alarms + found.inconclusive
