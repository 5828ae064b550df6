"""How rows are told, on the page and in the terminal: in a grid or a list, and what they share."""

import re
from collections.abc import Iterable, Sequence

from reports.results import Row

PIXELS = re.compile(r"^covers [\d,]+ pixels, ")


def crossed(places: Iterable[tuple[str, float]]) -> bool:
    """Whether lines and weights make a grid: several weights a line, and half of it filled.

    A suite whose objects have a weight each is better told as a list.
    """
    filled = set(places)
    lines, weights = {line for line, _ in filled}, {weight for _, weight in filled}
    return len(filled) > len(lines) and 2 * len(filled) >= len(lines) * len(weights)


def notes_of(rows: Sequence[Row]) -> tuple[list[str], dict[int, str]]:
    """What all of several rows note, and by place in `rows` what each notes besides.

    How many pixels an object covers stands beside its note; a reason such as "as mirror" is that of
    the object of that name.
    """
    noted = [_notes(row, rows) for row in rows]
    shared = [n for n in noted[0] if all(n in own for own in noted)] if len(rows) > 1 else []
    own = {i: [n for n in found if n not in shared] for i, found in enumerate(noted)}
    return shared, {i: "; ".join(found) for i, found in own.items() if found}


def _notes(row: Row, rows: Sequence[Row]) -> list[str]:
    """A row's notes, each once."""
    return list(dict.fromkeys(_resolved(n, rows) for n in row.note.split("; ") if n))


def _resolved(note: str, rows: Sequence[Row]) -> str:
    """A note without what differs from object to object though its reason does not."""
    note = PIXELS.sub("covers ", note)
    for other in rows:
        if note.startswith("covers ") and note.endswith(f": as {other.object}"):
            told = PIXELS.sub("covers ", other.note.split("; ")[0])
            return told if told.startswith("covers ") else note
    return note
