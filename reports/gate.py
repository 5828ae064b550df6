"""Verdicts: a row against its budget, and a run against its suite."""

import math
from collections.abc import Sequence
from pathlib import Path

from reports.results import Missing, Results, Row, Verdict
from scenes.errors import InputError
from scenes.suite import Budget, Entry

UPPER, LOWER = ("energy_error", "energy_local"), ("ssim", "silhouette")
INTERVALS = {
    "energy_error": "energy_ci95",
    "energy_local": "energy_local_ci95",
    "ssim": "ssim_ci95",
}


def budget_of(row: Row, rules: list[Budget]) -> tuple[dict[str, float], list[str]]:
    """The limits that hold for a row, and the reasons of the overrides among them."""
    limits, reasons = {}, []
    for rule in rules:
        if (rule.technique, rule.truth) != (row.technique, row.truth):
            continue
        if any(getattr(row, name) != value for name, value in rule.selectors.items()):
            continue
        limits |= {m: v for m in (*UPPER, *LOWER) if (v := getattr(rule, m)) is not None}
        if rule.reason:
            reasons.append(rule.reason)
    return limits, reasons


def check_rules(
    rules: Sequence[Budget], entries: Sequence[Entry], outside: str, path: Path
) -> None:
    """Refuse a rule that no row of the suite can meet: a typo would else switch it off.

    Raises:
        InputError: naming the rule.
    """
    rows = [
        {
            "scene": entry.case.scene,
            "environment": entry.case.environment.name,
            "object": obj.name,
            "material": obj.material.name,
            "weight": obj.material.weight,
            "technique": technique,
            "truth": truth,
        }
        for entry in entries
        for obj in entry.case.judged
        for technique in (*entry.techniques, outside)
        for truth in entry.truths
    ]
    for number, rule in enumerate(rules):
        if rule.truth == "physical":
            problem = "nothing is judged against `physical`, which draws another model"
            raise InputError(
                path, f"budget.{number}.truth", problem, "use `global` or `unoccluded`"
            )
        wanted = rule.selectors | {"technique": rule.technique, "truth": rule.truth}
        if not any(all(row[k] == v for k, v in wanted.items()) for row in rows):
            shown = ", ".join(f"{k} = {v}" for k, v in wanted.items())
            raise InputError(
                path, f"budget.{number}", f"matches no row ({shown})", "mend or remove it"
            )


def judge(row: Row, rules: list[Budget]) -> Row:
    """The row with its budget, margins and verdict.

    A figure passes when its whole interval does and fails when none of it does; in between it is
    inconclusive, and `note` says how many samples would decide. Margins are fractions of the
    budget, negative where the figure is over it.
    """
    limits, reasons = budget_of(row, rules)
    margins, verdicts = {}, []
    notes = [*filter(None, [row.note]), *(f"budget: {r}" for r in reasons)]
    for metric, limit in limits.items():
        value = getattr(row, metric)
        low, high = getattr(row, INTERVALS[metric]) if metric in INTERVALS else (value, value)
        verdict, margin = _verdict(metric, value, low, high, limit)
        margins[metric] = margin
        verdicts.append(verdict)
        if metric == "silhouette" and math.isnan(value):
            notes.append("silhouette: the candidate gives no object ids")
        if verdict == "inconclusive":
            notes.append(_samples_to_decide(row, metric, value, low, high, limit))
    if row.problem:
        verdict = "fail"
    else:
        order = ("fail", "inconclusive", "pass")
        verdict = next((v for v in order if v in verdicts), "reported")
    return row.model_copy(
        update={"budget": limits, "margins": margins, "verdict": verdict, "note": "; ".join(notes)}
    )


def _verdict(
    metric: str, value: float, low: float, high: float, limit: float
) -> tuple[Verdict, float]:
    """One figure against its limit, with its margin."""
    if math.isnan(value):
        return "fail", float("nan")
    if metric in LOWER:
        margin = (value - limit) / max(1 - limit, 1e-9)
        passes, fails = low >= limit, high < limit  # both false for an interval of NaN
    else:
        margin = 1 - abs(value) / limit
        reach = max(abs(low), abs(high))
        passes, fails = reach <= limit, low > limit or high < -limit
    return ("pass" if passes else "fail" if fails else "inconclusive"), margin


def _samples_to_decide(
    row: Row, metric: str, value: float, low: float, high: float, limit: float
) -> str:
    """How many samples would part the interval from the budget; its width falls as 1/sqrt(n)."""
    distance = abs(abs(value) - limit)
    if math.isnan(low) or math.isnan(high):
        return f"{metric}: the reference's noise hides it"
    if distance == 0:
        return f"{metric} lies on its budget"
    factor = ((high - low) / 2 / distance) ** 2
    if not math.isfinite(factor):
        return f"{metric}: its interval has no end"
    return f"{metric}: about {math.ceil(row.reference_spp * factor)} samples per pixel would decide"


def conclude(results: Results) -> Results:
    """The verdict of a whole run, with every reason for which it fails."""
    reasons = []
    if not results.rows:
        reasons.append("no case was compared")
    if results.missing:
        first = results.missing[0]
        reasons.append(
            f"{len(results.missing)} of {results.expected_rows} rows are missing, first "
            f"{first.case} {first.object} ({first.technique} against {first.truth})"
        )
    failed = [r for r in results.rows if r.verdict == "fail"]
    undecided = [r for r in results.rows if r.verdict == "inconclusive"]
    if failed:
        reasons.append(f"{len(failed)} of {len(results.rows)} rows fail")
    if undecided and not results.allow_inconclusive:
        reasons.append(f"{len(undecided)} rows are inconclusive at the cap of samples")
    if results.rows and not any(
        r.verdict in ("pass", "fail", "inconclusive") for r in results.rows
    ):
        reasons.append("no row has a budget, so nothing was judged")
    return results.model_copy(update={"verdict": "fail" if reasons else "pass", "reasons": reasons})


def worst_first(rows: list[Row]) -> list[Row]:
    """Rows by verdict (fail, inconclusive, pass, reported), then by their smallest margin."""
    order = {"fail": 0, "inconclusive": 1, "pass": 2, "reported": 3}

    def key(row: Row) -> tuple[int, int, float, float]:
        margins = [m for m in row.margins.values() if not math.isnan(m)]
        size = row.energy_local if not math.isnan(row.energy_local) else 0.0
        return order[row.verdict], 0 if row.problem else 1, min(margins, default=math.inf), -size

    return sorted(rows, key=key)


def missing_rows(expected: list[Missing], rows: list[Row]) -> list[Missing]:
    """Those of the expected rows that are not there."""
    there = {(r.case, r.object, r.technique, r.truth) for r in rows}
    return [m for m in expected if (m.case, m.object, m.technique, m.truth) not in there]
