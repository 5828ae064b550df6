"""Changes in words and tables: for the terminal and for the Markdown summary."""

import math
from collections import Counter
from collections.abc import Sequence

from rich import box
from rich.console import Console
from rich.table import Table

from reports.change.ranking import ORDER, by_row, harm, verdict_of
from reports.results import Change, Changes

STYLE = {"worse": "red", "better": "green", "unclear": "yellow", "unchanged": "dim"}
HEADINGS = ("changed", "row", "figure", "before", "now", "change of size", "95 % over blocks")
SHOWN = 20  # rows of a table
NAMES = {"energy_local": "local energy", "energy_error": "energy", "ssim": "SSIM", "flip": "FLIP"}


def counted(changes: Changes) -> str:
    """How many rows changed which way."""
    count = Counter(verdict_of(own) for own in by_row(changes).values())
    told = [f"{count[name]} {name}" for name in ORDER if count[name]]
    if changes.incomparable:
        told.append(f"{len(changes.incomparable)} not comparable")
    return ", ".join(told) or "no rows"


def heading(changes: Changes) -> str:
    """Since which run."""
    return f"since {changes.path} ({changes.suite}, {changes.created})"


def cells(change: Change) -> tuple[str, ...]:
    """The cells of one figure under HEADINGS, but for the first."""
    told = [shown(change, v) for v in (change.old, change.new)]
    noise = "" if change.paired else f" (not paired: {change.reason})"
    return (
        change.named,
        NAMES[change.figure],
        *told,
        shown(change, change.change, signed=True),
        f"{shown(change, change.low, True)} to {shown(change, change.high, True)}{noise}",
    )


def shown(change: Change, value: float, signed: bool = False) -> str:
    """A figure of a change, or how far it moved; energies in percent."""
    if not math.isfinite(value):
        return "unknown"
    sign = "+" if signed else ""
    if change.figure.startswith("energy"):
        return f"{value:{sign}.2%}"
    return f"{value:{sign}.4f}"


def telling(changes: Changes) -> list[tuple[str, Change]]:
    """Of each row that changed the figure that changed most, with the row's verdict."""
    rows = ((verdict_of(own), own) for own in by_row(changes).values())
    return [
        (verdict, max((c for c in own if c.verdict == verdict), key=lambda c: abs(harm(c))))
        for verdict, own in rows
        if verdict != "unchanged"
    ]


def worst(own: Sequence[Change]) -> str:
    """A row that got worse in one line: the figure that got worst."""
    change = max((c for c in own if c.verdict == "worse"), key=harm)
    _, figure, old, new, moved, interval = cells(change)
    return f"worse: {figure} {old} to {new} ({moved}, {interval})"


def print_changes(changes: Changes, console: Console) -> None:
    """The rows that changed, the worst first, and what could not be compared."""
    rows = telling(changes)
    if rows:
        table = Table(box=box.SIMPLE_HEAD, title=f"What changed {heading(changes)}")
        for name in HEADINGS:
            table.add_column(name, justify="left" if name in HEADINGS[:3] else "right")
        for verdict, change in rows[:SHOWN]:
            table.add_row(verdict, *cells(change), style=STYLE[verdict])
        console.print(table)
    for one in changes.incomparable[:SHOWN]:
        console.print(f"not comparable: {one.named}: {one.reason}", soft_wrap=True, markup=False)
    console.print(f"changed {heading(changes)}: {counted(changes)}", soft_wrap=True, markup=False)


def markdown(changes: Changes) -> list[str]:
    """The same as lines of Markdown."""
    lines = [f"What changed {heading(changes)}: {counted(changes)}.", ""]
    if rows := telling(changes)[:SHOWN]:
        lines += [f"| {' | '.join(HEADINGS)} |", f"|{' --- |' * len(HEADINGS)}"]
        lines += [f"| {' | '.join((verdict, *cells(change)))} |" for verdict, change in rows] + [""]
    return lines
