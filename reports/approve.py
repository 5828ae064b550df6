"""New budgets from what was measured: only ever tighter, unless somebody says why."""

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomlkit

from reports.gate import LOWER, SELECTORS, UPPER, bounds
from reports.results import Results, Row
from scenes.errors import InputError
from scenes.suite import Budget

SPARE = 0.1  # of a figure, beside its interval
LEAST_LACK = {"silhouette": 5e-3}  # another rasteriser moves some pixels of an edge
DIGITS = 2  # of an error, and of what SSIM lacks


@dataclass(frozen=True)
class Proposal:
    """A budget's new limit, and the row that sets it.

    Attributes:
        rule: its number in the suite.
        looser: whether it allows more than before.
    """

    rule: int
    metric: str
    old: float
    new: float
    row: Row
    looser: bool


def proposals(results: Results, rules: tuple[Budget, ...], spare: float = SPARE) -> list[Proposal]:
    """What each budget could be: the worst of its rows, its noise, and a share to spare.

    A rule that no measured row follows keeps its limits, and so does one where the new limit is
    as large as the old one.

    Args:
        rules: of the suite, in its order; of several for a row the last one counts.
        spare: the share of the worst figure that a later run may be worse by.
    """
    found = []
    for number, rule in enumerate(rules):
        for metric in (*UPPER, *LOWER):
            old = getattr(rule, metric)
            followers = [r for r in results.rows if _rule_of(r, rules, metric) == number]
            if old is None or not followers:
                continue
            limits = {row_limit(r, metric, spare): r for r in followers}
            new = min(limits) if metric in LOWER else max(limits)
            if new != old:
                looser = new < old if metric in LOWER else new > old
                found.append(Proposal(number, metric, old, new, limits[new], looser))
    return found


def row_limit(row: Row, metric: str, spare: float) -> float:
    """The budget that a row's figure would keep with something to spare, rounded to be kept."""
    low, high = bounds(row, metric, row.confidence)
    if metric in LOWER:
        lacks = max((1 - low) * (1 + spare), LEAST_LACK.get(metric, 0.0))
        return round(max(1 - _rounded_up(lacks), 0), 6)
    return _rounded_up(max(abs(low), abs(high)) * (1 + spare))


def check(results: Results, rules: tuple[Budget, ...], path: Path) -> None:
    """Refuse results that budgets cannot be taken from.

    Args:
        rules: of the suite as it is now.

    Raises:
        InputError: a part of the suite was not measured, or not measurable, or its budgets were
            others then.
    """
    if tuple(results.budgets) != rules:
        problem = "are not those of the suite any more"
        raise InputError(path, "budgets", problem, "run the suite again")
    if results.skipped or results.missing:
        problem = "holds only a part of its suite"
        raise InputError(path, "skipped", problem, "run the whole suite, without --filter")
    judged = [r for r in results.rows if r.budget]
    if not judged:
        raise InputError(path, "rows", "no row has a budget", "add a [[budget]] to the suite")
    for row in judged:
        hidden = [m for m in row.budget if not math.isfinite(sum(bounds(row, m, row.confidence)))]
        if row.problem or hidden:
            thing = f"{row.object} in {row.case}"
            what = row.problem or f"{hidden[0]} of {thing} is infinite or has no interval"
            raise InputError(path, "rows", what, "mend that, or give more samples")


def rewritten(text: str, chosen: list[Proposal], reason: str) -> str:
    """A suite's TOML with the chosen limits; comments and order stay as they are.

    A looser limit gets the reason beside those that its rule gives.
    """
    document = tomlkit.parse(text)
    for proposal in chosen:
        rule = document["budget"][proposal.rule]
        rule[proposal.metric] = proposal.new
        if proposal.looser:
            rule["reason"] = _joined(rule, reason)
    return tomlkit.dumps(document)


def difference(before: str, after: str, name: str) -> str:
    """Two texts of a suite as a unified diff."""
    lines = (text.splitlines(keepends=True) for text in (before, after))
    return "".join(difflib.unified_diff(*lines, f"a/{name}", f"b/{name}", n=6))


def _joined(rule: Mapping[str, Any], reason: str) -> str:
    known = str(rule.get("reason", ""))
    return known if reason in known.split("; ") else "; ".join(filter(None, (known, reason)))


def _rule_of(row: Row, rules: tuple[Budget, ...], metric: str) -> int | None:
    """The number of the rule whose limit holds for a row."""
    if metric not in row.budget:
        return None
    identity = row.model_dump(include={*SELECTORS})
    for number in reversed(range(len(rules))):
        rule = rules[number]
        wanted = rule.selectors | {"technique": rule.technique, "truth": rule.truth}
        if getattr(rule, metric) is not None and all(identity[k] == v for k, v in wanted.items()):
            return number
    return None


def _rounded_up(value: float) -> float:
    """To DIGITS significant digits; never down, so that what was measured passes."""
    if value <= 0:
        return 10.0**-6
    step = 10.0 ** (math.floor(math.log10(value)) - DIGITS + 1)
    return round(math.ceil(value / step - 1e-9) * step, 9)
