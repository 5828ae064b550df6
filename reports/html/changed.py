"""What changed since an earlier run, as the page shows it."""

from dataclasses import dataclass

from reports.change.figures import TOLERANCES
from reports.change.ranking import harm
from reports.change.told import NAMES, cells, counted, heading, telling
from reports.html.figures import digits
from reports.html.matrix import row_id
from reports.results import Changes, Results

STATES = {"worse": "fail", "better": "pass", "unclear": "inconclusive"}  # as badges are coloured


@dataclass(frozen=True)
class Line:
    """A row that changed; `harm` is in tolerances, negative where it got better."""

    verdict: str
    state: str
    href: str
    cells: tuple[str, ...]
    harm: str


@dataclass(frozen=True)
class ChangedView:
    """The section: how many rows changed, which, and what could not be compared."""

    counts: str
    since: str
    tolerances: str
    lines: list[Line]
    incomparable: list[str]


def changed_of(results: Results) -> ChangedView | None:
    """The section, if the run was held against an earlier one."""
    if not results.changed:
        return None
    return _view(results, results.changed)


def _view(results: Results, changes: Changes) -> ChangedView:
    hrefs = {r.key: row_id(r) for r in results.rows}
    lines = []
    for verdict, change in telling(changes):
        own = hrefs.get(change.key, "")
        lines.append(Line(verdict, STATES[verdict], own, cells(change), f"{harm(change):.4g}"))
    return ChangedView(
        counts=counted(changes),
        since=heading(changes),
        tolerances=", ".join(f"{NAMES[n]} {digits(t)}" for n, t in TOLERANCES.items()),
        lines=lines,
        incomparable=[f"{one.named}: {one.reason}" for one in changes.incomparable],
    )
