"""Limits of detection and false alarms: errors of known size, judged on sets of batches."""

import datetime
import tempfile
import time
from pathlib import Path

from reports.limits.detection import draws
from reports.limits.known_errors import known_errors
from reports.limits.results import Limit, Limits
from reports.progress import reporting
from reports.run.job import Job, make_folder
from reports.run.limits.alarms import false_alarms
from reports.run.limits.judging import Gate, clearance, pools
from reports.run.limits.seen import Seen
from reports.run.provenance import provenance
from scenes.errors import InputError


def limits(job: Job, sets: int, alarms: int, size: int) -> Limits:
    """Measure both, with the batches that are stored and more where they are too few.

    Args:
        sets: of batches, for each size of each error.
        alarms: sets for each harmless picture.
        size: batches of each reference that sets are drawn from.

    Raises:
        InputError: nothing has a budget, the pool is too small for what the gate may take, or the
            renderer as it is misses a budget.
    """
    start = time.perf_counter()
    make_folder(job.out, "--out")
    gate = Gate(job, [])
    if size < 2 * gate.looks[-1]:
        problem = f"is too small a pool: the gate takes up to {gate.looks[-1]} batches here"
        raise InputError("--pool", str(size), problem, f"give at least {2 * gate.looks[-1]}")
    judged = {rule.technique for rule in job.suite.budget}
    labels = sorted({t for e in job.entries for t in e.techniques} & judged)
    if not labels:
        problem, remedy = "judges none of its techniques", "add a [[budget]] for one"
        raise InputError(job.path, "budget", problem, remedy)
    gate.pools = pools(job, size)
    with tempfile.TemporaryDirectory() as folder:
        errors = [(error, sign) for error in known_errors(Path(folder)) for sign in (1, -1)]
        _as_it_is(job, Seen(gate, draws(size, 1), errors[0][0], 1), labels)
        told, orders = false_alarms(gate, draws(size, alarms)), draws(size, sets)
        found: list[Limit] = []
        with reporting(len(errors)) as report:
            for error, sign in errors:
                report.step(f"{error.parameter}, too {'large' if sign > 0 else 'small'}")
                seen = Seen(gate, orders, error, sign)
                found += [seen.limit(own) for own in _groups(labels)]
    return Limits(
        created=datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        seconds=time.perf_counter() - start,
        command=job.command,
        suite=job.path.stem,
        pool=size,
        provenance=provenance(),
        limits=found,
        false_alarms=told,
    )


def _groups(labels: list[str]) -> list[list[str]]:
    """Every technique by itself, then all of them together."""
    return [[label] for label in labels] + ([labels] if len(labels) > 1 else [])


def _as_it_is(job: Job, seen: Seen, labels: list[str]) -> None:
    """See that the renderer without any error meets its budgets, or there is no limit."""
    for label in labels:
        for place, row in seen.rows(0.0, label).items():
            if clearance(row)[0] > 0:
                problem = f"{label} misses it without any error"
                where = f"{row.case} {place.object}: {clearance(row)[1]}"
                raise InputError(job.path, where, problem, "mend the budget or the renderer")
