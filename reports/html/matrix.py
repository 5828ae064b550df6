"""The matrices on the first screen: material down, weight across, one figure a cell.

Where most cells would be empty they are lists: a material and a weight a line.
"""

import math
from dataclasses import dataclass, replace

from reports.gate import LOWER, worst_first
from reports.html.figures import METRICS, Metric, slug
from reports.html.verdict import subject
from reports.results import Row
from reports.telling import crossed

SHOWN = ("energy_local", "energy_error", "ssim")


@dataclass(frozen=True)
class Cell:
    """One figure beside its budget.

    Attributes:
        state: a CSS class: over, within, reported or broken, with a depth of 1 to 3.
        hidden: why the spread is not known, if it is not.
        undecided: noise hides whether the figure is within the budget.
        label: all of it in words, for a tooltip and a screen reader.
        place: of which case the figure is, where there are several.
        nearest: the figure that is closest to its budget, and that, if it is another one.
    """

    text: str
    spread: str
    hidden: str
    limit: str
    state: str
    undecided: bool
    label: str
    href: str
    place: str = ""
    nearest: str = ""


@dataclass(frozen=True)
class Line:
    """The cells of a material by weight; in a list one cell, and its weight."""

    material: str
    weight: str
    cells: list[Cell | None]


@dataclass(frozen=True)
class Matrix:
    """One figure over material and weight for one technique and truth; a list has no `weights`."""

    metric: str
    technique: str
    truth: str
    weights: list[str]
    lines: list[Line]


def matrices(rows: list[Row]) -> list[Matrix]:
    """One matrix for each shown figure, technique and truth, in the order of the rows."""
    pairs = dict.fromkeys((r.technique, r.truth) for r in rows)
    made = []
    for technique, truth in pairs:
        chosen = [r for r in rows if (r.technique, r.truth) == (technique, truth)]
        places = dict.fromkeys((label_of(r, rows), r.weight) for r in chosen)
        labels = dict.fromkeys(label for label, _ in places)
        weights = sorted({w for _, w in places})
        grid = crossed(places)
        for name in SHOWN:
            cells = {at: _worst_cell(METRICS[name], chosen, rows, *at) for at in places}
            if grid:
                lines = [Line(x, "", [cells.get((x, w)) for w in weights]) for x in labels]
            else:
                lines = [
                    Line(x, f"{w:g}", [cells[x, w]])
                    for x in labels for w in weights if (x, w) in cells
                ]  # fmt: skip
            shown = [f"{w:g}" for w in weights] if grid else []
            made.append(Matrix(name, technique, truth, shown, lines))
    return made


def label_of(row: Row, rows: list[Row]) -> str:
    """The material, with its roughness or metallic where the run has several of it."""
    same = [r for r in rows if r.material == row.material]
    label = row.material
    if len({r.roughness for r in same}) > 1:
        label += f", roughness {row.roughness:g}"
    if len({r.metallic for r in same}) > 1:
        label += f", metallic {row.metallic:g}"
    return label


def cell(metric: Metric, row: Row) -> Cell:
    """One row's figure as a cell."""
    limit = row.budget.get(metric.name)
    allowed = metric.allowed(limit) if limit is not None else ""
    value, undecided = metric.value(row), metric.undecided(row)
    text, spread, hidden = metric.show(value), metric.spread(row), metric.hidden(row)
    told = f"{spread}: {hidden}" if hidden else spread
    words = [f"{subject(row)}: {metric.label} {text} {told}".rstrip()]
    words.append(f"budget {allowed}" if allowed else "no budget: reported only")
    if undecided:
        words.append("noise hides the answer")
    if row.problem:
        words.append(row.problem)
    elif math.isnan(value):
        words.append("no figure: it is infinite or was not measured")
    href = f"#{row_id(row)}"
    state = _state(metric, row, value)
    return Cell(text, spread, hidden, allowed, state, undecided, "; ".join(words), href)


def row_id(row: Row) -> str:
    """The id of a row on the page."""
    return slug("row", *row.key)


def _worst_cell(
    metric: Metric, chosen: list[Row], rows: list[Row], label: str, weight: float
) -> Cell:
    """The largest error of a material at a weight, in the state of what is closest to its budget.

    The two can be different rows, since budgets differ by case.
    """
    here = [r for r in chosen if r.weight == weight and label_of(r, rows) == label]
    ranked = worst_first(here)
    largest = min(ranked, key=lambda r: _error(metric, r))
    shown = cell(metric, largest)
    if len(here) == 1:
        return shown
    words = [shown.label, f"the largest error of {len(here)} places, {_place(largest, here)}"]
    judged = [r for r in ranked if metric.name in r.budget and not math.isnan(metric.value(r))]
    nearest = min(judged, key=lambda r: r.margins[metric.name], default=largest)
    told, state, undecided = "", shown.state, shown.undecided
    if nearest is not largest and not math.isnan(metric.value(largest)):
        other, limit = cell(metric, nearest), metric.bare(nearest.budget[metric.name])
        told = f"{other.text} of {limit}"
        state, undecided = other.state, other.undecided
        words.append(f"closest to its budget: {told}, {_place(nearest, here)}")
    return replace(
        shown,
        state=state,
        undecided=undecided,
        label="; ".join(words),
        place=_place(largest, here),
        nearest=told,
    )


def _place(row: Row, here: list[Row]) -> str:
    """The case of a row, with the object where the case has several of them here."""
    alike = sum(r.case == row.case for r in here) > 1
    return f"{row.case}, {row.object}" if alike else row.case


def _error(metric: Metric, row: Row) -> tuple[int, float]:
    """Sorts the worst first: no figure, then the largest error."""
    value = metric.value(row)
    if math.isnan(value):
        return 0, 0.0
    return 1, value if metric.name in LOWER else -abs(value)


def _state(metric: Metric, row: Row, value: float) -> str:
    if math.isnan(value):
        return "broken" if row.problem or metric.name in row.budget else "reported"
    margin = row.margins.get(metric.name, math.nan)
    if math.isnan(margin):
        return "reported"
    if margin < 0:
        return f"over{1 + (margin < -0.25) + (margin < -1)}"
    return f"within{1 + (margin > 0.25) + (margin > 0.5)}"
