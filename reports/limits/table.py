"""What was found of the gate's limits, in a terminal."""

from rich import box
from rich.console import Console
from rich.table import Table

from reports.limits.results import EVERY, Limit, Limits

MARKS = {"": "", "relative": " %", "degrees": "°"}


def print_limits(found: Limits, console: Console) -> None:
    """The limits of the whole suite, those of each technique, and false alarms."""
    for technique in dict.fromkeys([EVERY, *(x.technique for x in found.limits)]):
        own = [x for x in found.limits if x.technique == technique]
        if own:
            console.print(_table(technique, own))
    for told in found.false_alarms:
        console.print(
            f"{told.what}: {told.alarms} false alarms in {told.sets} sets of batches, at most "
            f"{told.high:.1%} at 95 %; {told.inconclusive} inconclusive",
            soft_wrap=True,
        )


def _table(technique: str, limits: list[Limit]) -> Table:
    named = "the whole suite" if technique == EVERY else technique
    table = Table(title=f"caught 95 times in 100 by {named}", box=box.SIMPLE_HEAD)
    for heading in ("error", "smallest", "95 % interval", "without noise"):
        table.add_column(heading, justify="left" if heading == "error" else "right")
    table.add_column("limited by")
    table.add_column("seen by")
    for x in limits:
        interval = f"{sized(x, x.low)} to {sized(x, x.high)}"
        if x.smallest is None:
            interval = f"over {sized(x, x.low)}"
        table.add_row(
            f"{x.parameter} {x.sign}", sized(x, x.smallest), interval, sized(x, x.noiseless),
            x.limited_by, x.seen_by or x.words,
        )  # fmt: skip
    return table


def sized(limit: Limit, size: float | None) -> str:
    """A size with its unit; a dash where there is none."""
    if size is None:
        return "–"
    return f"{size * 100 if limit.unit == 'relative' else size:.2g}{MARKS[limit.unit]}"
