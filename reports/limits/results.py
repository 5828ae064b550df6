"""limits.json: the smallest errors that the gate catches, and how often it cries wolf."""

from pathlib import Path
from typing import Any, Literal

from reports.record import Record, load, save
from reports.results import Figure

SCHEMA_VERSION = 1
EVERY = "all"  # the whole suite: a gate fails if any row of any technique does


class Point(Record):
    """What the gate said of one size of an error, over all sets of batches.

    `caught`: it failed a row. `inconclusive`: it failed none, and could not pass them all either.
    """

    size: float
    caught: int
    inconclusive: int
    of: int


class Limit(Record):
    """The smallest size of one error that the gate catches 95 times in 100.

    Attributes:
        parameter: what is wrong, such as "roughness".
        unit: of the sizes: "" for a plain number, "relative", or "degrees".
        sign: whether the parameter is too large or too small by the size.
        technique: whose rows are judged, or "all".
        smallest: that size; None where not even the largest that was tried is caught so often.
        low, high: its 95 % interval; a side is None where no tried size bounds it.
        noiseless: the size from which a reference without noise would let the gate catch it; None
            where it would catch none that was tried.
        curve: by rising size.
        seen_by: the row and figure that sees it first; "" where none does.
        limited_by: whether most of `smallest` is the budget's slack over the technique's own error
            (up to `noiseless`) or the reference's noise (the rest).
        words: the same for a reader, in a sentence.
    """

    parameter: str
    unit: Literal["", "relative", "degrees"]
    sign: Literal["+", "-"]
    technique: str
    smallest: float | None
    low: float | None
    high: float | None
    noiseless: float | None
    curve: list[Point]
    seen_by: str
    limited_by: Literal["budget", "noise"]
    words: str


class FalseAlarms(Record):
    """How often the gate failed what is right.

    Attributes:
        what: was drawn.
        sets: of batches, drawn at random from a pool.
        alarms: sets for which a row failed.
        inconclusive: sets for which none failed and a row was inconclusive.
        low, high: 95 % interval of the share of alarms (Clopper and Pearson 1934).
    """

    what: str
    sets: int
    alarms: int
    inconclusive: int
    low: Figure
    high: Figure


class Limits(Record):
    """One run of `shadeproof limits`.

    Attributes:
        pool: batches of each reference that sets were drawn from, without replacement.
    """

    schema_version: Literal[1] = SCHEMA_VERSION
    created: str
    seconds: Figure
    command: str
    suite: str
    pool: int
    provenance: dict[str, Any]
    limits: list[Limit]
    false_alarms: list[FalseAlarms]


def save_limits(limits: Limits, path: Path) -> None:
    """Write limits.json whole or not at all."""
    save(limits, path)


def load_limits(path: Path) -> Limits:
    """Read a limits.json; see `reports.record.load`."""
    return load(Limits, path, f"limits.json of schema {SCHEMA_VERSION}", "shadeproof limits")
