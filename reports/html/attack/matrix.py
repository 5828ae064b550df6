"""Which bugs the gate sees: one cell for each file and rule."""

from collections.abc import Sequence
from dataclasses import dataclass

from reports.attack.results import Mutant

WRITTEN = "realistic"  # the column of what no rule made


@dataclass(frozen=True)
class Cell:
    """The bugs of one file and rule.

    Attributes:
        text: caught of those that a user could see; empty where no such bug was drawn.
        note: what else there is: equivalent ones, stillborn ones and timeouts.
        state: a colour class of report.css.
        label: the same in a sentence.
        href: the list that tells of each.
    """

    text: str
    note: str
    state: str
    label: str
    href: str


@dataclass(frozen=True)
class BugMatrix:
    """Rules along, files down; None where there was nothing to change."""

    rules: list[str]
    lines: list[tuple[str, str, list[Cell | None]]]


def bug_matrix(mutants: Sequence[Mutant], list_id: dict[str, str]) -> BugMatrix:
    """All bugs, controls left out.

    Args:
        list_id: of each file, the id of the list that tells of its bugs.
    """
    bugs = [m for m in mutants if m.kind != "control"]
    rules = [*sorted({column_of(m) for m in bugs} - {WRITTEN}), WRITTEN]
    rules = [r for r in rules if any(column_of(m) == r for m in bugs)]
    lines: list[tuple[str, str, list[Cell | None]]] = []
    for file in sorted({m.file for m in bugs}):
        own = {r: [m for m in bugs if m.file == file and column_of(m) == r] for r in rules}
        cells = [_cell(file, r, own[r], list_id[file]) if own[r] else None for r in rules]
        lines.append((file, list_id[file], cells))
    return BugMatrix(rules, lines)


def column_of(mutant: Mutant) -> str:
    """The rule that made a bug."""
    return mutant.rule if mutant.kind == "rule" else WRITTEN


def _cell(file: str, rule: str, own: Sequence[Mutant], href: str) -> Cell:
    caught = sum(m.outcome == "caught" for m in own)
    missed = sum(m.outcome == "survived" and not m.equivalent for m in own)
    equal = sum(m.outcome == "survived" and bool(m.equivalent) for m in own)
    dead = sum(m.outcome == "stillborn" for m in own)
    slow = sum(m.outcome == "timeout" for m in own)
    seen = caught + missed
    notes = [
        *([f"{equal} equivalent"] if equal else []),
        *([f"{dead} stillborn"] if dead else []),
        *([f"{slow} timeout"] if slow else []),
    ]
    state = (
        "over2" if missed else "within2" if caught else "within1 undecided" if equal else "reported"
    )
    told = [f"{caught} of {seen} caught"] * bool(seen) + notes
    return Cell(
        text=f"{caught}/{seen}" if seen else "",
        note=", ".join(notes),
        state=state,
        label=f"{file}, {rule}: {', '.join(told)}",
        href=href,
    )
