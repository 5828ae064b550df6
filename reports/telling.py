"""How rows are told, on the page and in the terminal: in a grid or a list, and what they share."""

import re
import shlex
from collections.abc import Iterable, Sequence
from pathlib import Path

from reports.results import Results, Row

SMALL = re.compile(r"^covers [\d,]+ pixels, under ([\d,]+):")


def crossed(places: Iterable[tuple[str, float]]) -> bool:
    """Whether lines and weights make a grid: several weights a line, and half of it filled.

    A suite whose objects have a weight each is better told as a list.
    """
    filled = set(places)
    lines, weights = {line for line, _ in filled}, {weight for _, weight in filled}
    return len(filled) > len(lines) and 2 * len(filled) >= len(lines) * len(weights)


def again(results: Results, case: str, out: Path) -> str:
    """The command that shows one case of a run in `out` again, in a report of its own."""
    command = results.command.replace(" --verdict-only", "")
    # Of an option that is given twice the last one counts.
    own = ["--filter", case, "--out", str(out / "again")]
    return f"{command} {shlex.join(own)}" if command else ""


def notes_of(rows: Sequence[Row]) -> tuple[list[str], list[str]]:
    """What all of several rows note, and row by row what each notes besides.

    How many pixels an object covers is a figure of its row; a reason such as "as mirror" is that of
    the object of that name.
    """
    reasons = {row.object: _reason(row.note) for row in rows}
    noted = [_notes(row.note, reasons) for row in rows]
    shared = [n for n in noted[0] if all(n in own for own in noted)] if len(rows) > 1 else []
    return shared, ["; ".join(n for n in own if n not in shared) for own in noted]


def _notes(note: str, reasons: dict[str, str]) -> list[str]:
    """The parts of a row's note, each once."""
    reason = _reason(note)
    if reason.startswith("as "):
        reason = reasons.get(reason.removeprefix("as ")) or reason
    told = SMALL.sub(r"covers under \1 pixels:", note).split("; ")
    if reason:
        told[0] = f"{told[0].split(': ', 1)[0]}: {reason}"
    return list(dict.fromkeys(filter(None, told)))


def _reason(note: str) -> str:
    """Why an object may be small; empty where a note does not tell."""
    first = note.split("; ", 1)[0]
    return first.split(": ", 1)[1] if SMALL.match(first) else ""
