"""The one sentence on top: what is worst, where, and by how much."""

import math

from reports.gate import budget_of, headline
from reports.html.figures import METRICS, decisive, percent
from reports.results import Results, Row


def sentence(results: Results, ranked: list[Row]) -> str:
    """The verdict in one sentence, naming the worst material, weight and place.

    Args:
        ranked: the rows, worst first.
    """
    head = headline(results).upper() + _part(results)
    if not ranked:
        return f"{head}: {results.reasons[0] if results.reasons else 'no row was compared'}."
    worst = ranked[0]
    if results.verdict == "fail" and worst.verdict in ("pass", "reported") and results.reasons:
        # The rows are not to blame: say why it fails before what comes closest.
        return f"{head}: {results.reasons[0]}; {_clause(worst)}."
    return f"{head}: {_clause(worst)}."


def caution(results: Results) -> str:
    """What a pass does not say; empty where the run fails."""
    if results.verdict != "pass":
        return ""
    overrides = [b for b in results.budgets if b.selectors and b.reason]
    eased = sum(bool(budget_of(r, overrides)[1]) for r in results.rows)
    count = f"{eased} of {len(results.rows)} rows use" if eased else "no row uses"
    return (
        "Budgets are limits chosen in the suite, not a promise of quality; "
        f"{count} an override with a reason."
    )


def _part(results: Results) -> str:
    """How much of the suite was asked for; empty where it was all of it."""
    if not results.skipped:
        return ""
    asked, skipped = len(results.rows) + len(results.missing), len(results.skipped)
    rows = f"{asked} of {results.expected_rows} rows were asked for"
    if results.expected_rows <= asked:
        rows = "only a part of the suite was asked for"
    return f" ({rows}; {skipped} case{'s' * (skipped != 1)} skipped by the filter)"


def subject(row: Row) -> str:
    """Who and where: material, weight, case, and the object if it adds anything."""
    thing = "" if row.object == row.material else f" on {row.object}"
    return f"{row.material} (weight {row.weight:g}){thing} in {row.case}"


def against(row: Row) -> str:
    """Which technique was held against which truth."""
    return f"{row.technique} vs {row.truth}"


def _clause(row: Row) -> str:
    who, pair, name = subject(row), against(row), decisive(row)
    if row.problem:
        return f"{who} could not be compared: {row.problem.rstrip('.')} ({pair})"
    if not name:
        error = percent(row.energy_local)
        return f"the largest local energy error is {error}, of {who} ({pair})"
    metric = METRICS[name]
    spread = f" {metric.spread(row)}" if metric.spread(row) else ""
    limit = metric.bare(row.budget[name])
    if math.isnan(metric.value(row)):
        return (
            f"{who} has no figure to hold against its {metric.budget_label} budget of {limit}: "
            f"it is infinite or was not measured ({pair})"
        )
    figures = f"{metric.show(metric.value(row))}{spread} against {limit} ({pair})"
    if row.verdict == "fail":
        return f"{who} misses its {metric.budget_label} budget: {figures}"
    if row.verdict == "inconclusive":
        return f"noise hides whether {who} keeps its {metric.budget_label} budget: {figures}"
    return f"every budget is kept, the closest is {metric.budget_label} of {who}: {figures}"
