"""Progress on long work: a bar on a terminal, plain lines in CI."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

console = Console(stderr=True, highlight=False)


class Reporter:
    """Says what is being done, step by step."""

    def __init__(self, total: int, bar: Progress | None) -> None:
        self.total, self.bar, self.done = total, bar, 0
        self.task = bar.add_task("", total=total) if bar else None

    def step(self, text: str) -> None:
        """Begin the next step."""
        self.done += 1
        if self.bar:
            self.bar.update(self.task, completed=self.done - 1, description=text)
        else:
            print(f"[{self.done}/{self.total}] {text}", file=sys.stderr, flush=True)

    def detail(self, text: str) -> None:
        """More about the present step; shown on a terminal only."""
        if self.bar:
            self.bar.update(self.task, description=text)


@contextmanager
def reporting(total: int) -> Iterator[Reporter]:
    """A Reporter for `total` steps."""
    if os.environ.get("CI") or not console.is_terminal:
        yield Reporter(total, None)
        return
    columns = (
        BarColumn(24),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.description}"),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        yield Reporter(total, bar)
