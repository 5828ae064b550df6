"""history.jsonl: what earlier runs of a suite found, a line each, for the report's trends."""

import math
from pathlib import Path

from pydantic import ValidationError

from reports.record import Record
from reports.results import Figure, Results
from scenes.errors import InputError
from scenes.files import read_text
from scenes.frame import write_text
from scenes.words import first_mistake

NAME = "history.jsonl"
MOST = 200  # runs that are kept, of all suites

Key = tuple[str, str, str]  # case, technique, truth


class Past(Record):
    """The worst local energy error of a case's objects, by technique and truth, in one run."""

    case: str
    technique: str
    truth: str
    energy_local: Figure


class Run(Record):
    """One run: when, of which suite, and what it found."""

    created: str
    suite: str
    verdict: str
    worst: list[Past]


def remember(results: Results, folder: Path) -> None:
    """Add a run to the history in its folder; the oldest ones go.

    Raises:
        InputError: the file cannot be read or written.
    """
    runs = load_history(folder)
    runs.append(
        Run(
            created=results.created,
            suite=results.suite,
            verdict=results.verdict,
            worst=[
                Past(case=case, technique=technique, truth=truth, energy_local=worst)
                for (case, technique, truth), worst in _worst(results).items()
            ],
        )
    )
    lines = (run.model_dump_json() + "\n" for run in runs[-MOST:])
    write_text(folder / NAME, "".join(lines))


def load_history(folder: Path) -> list[Run]:
    """The runs that a folder remembers, the oldest first; none where it remembers none.

    Raises:
        InputError: a line of it is no run.
    """
    path = folder / NAME
    if not path.exists():
        return []
    runs = []
    for number, line in enumerate(read_text(path, "").splitlines(), start=1):
        try:
            runs.append(Run.model_validate_json(line))
        except ValidationError as error:
            problem = f"is no run ({' '.join(first_mistake(error)[:2]).strip()})"
            raise InputError(path, f"line {number}", problem, "remove it") from error
    return runs


def trends(runs: list[Run], suite: str) -> dict[Key, list[tuple[str, float]]]:
    """When and how large each case's worst local energy error was, in the runs of a suite."""
    found: dict[Key, list[tuple[str, float]]] = {}
    for run in runs:
        for past in run.worst if run.suite == suite else ():
            key = past.case, past.technique, past.truth
            if math.isfinite(past.energy_local):
                found.setdefault(key, []).append((run.created, past.energy_local))
    return found


def _worst(results: Results) -> dict[Key, float]:
    worst: dict[Key, float] = {}
    for row in results.rows:
        key = row.case, row.technique, row.truth
        if math.isfinite(row.energy_local):
            worst[key] = max(worst.get(key, 0.0), row.energy_local)
    return worst
