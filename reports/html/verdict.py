"""The one sentence on top: what is worst, where, and by how much."""

from reports.html.figures import GAP, METRICS, percent, tightest
from reports.results import Results, Row


def sentence(results: Results, ranked: list[Row]) -> str:
    """The verdict in one sentence, naming the worst material, weight and place.

    Args:
        ranked: the rows, worst first.
    """
    head = results.verdict.upper()
    if not ranked:
        return f"{head}: {results.reasons[0] if results.reasons else 'no row was compared'}."
    worst = ranked[0]
    if results.verdict == "fail" and worst.verdict in ("pass", "reported") and results.reasons:
        # The rows are not to blame: say why it fails before what comes closest.
        return f"{head}: {results.reasons[0]}; {_clause(worst)}."
    return f"{head}: {_clause(worst)}."


def subject(row: Row) -> str:
    """Who and where: material, weight, scene, environment and the object if it adds anything."""
    thing = "" if row.object == row.material else f" on {row.object}"
    return f"{row.material} (weight {row.weight:g}){thing} in {row.scene}/{row.environment}"


def against(row: Row) -> str:
    """Which technique was held against which truth."""
    return f"{row.technique} vs {row.truth}"


def _clause(row: Row) -> str:
    who, pair, name = subject(row), against(row), tightest(row)
    if row.problem:
        return f"{who} could not be compared: {row.problem.rstrip('.')} ({pair})"
    if not name:
        error = percent(row.energy_local)
        return f"the largest local energy error is {error}, of {who} ({pair})"
    metric = METRICS[name]
    spread = f" {metric.spread(row)}" if metric.spread(row) else ""
    limit = metric.allowed(row.budget[name]).split(GAP, 1)[1]
    figures = f"{metric.show(metric.value(row))}{spread} against {limit} ({pair})"
    if row.verdict == "fail":
        return f"{who} misses its {metric.budget_label} budget: {figures}"
    if row.verdict == "inconclusive":
        return f"noise hides whether {who} keeps its {metric.budget_label} budget: {figures}"
    return f"every budget is kept, the closest is {metric.budget_label} of {who}: {figures}"
