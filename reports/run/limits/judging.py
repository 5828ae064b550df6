"""What the gate says of a picture by any batches of a pool."""

import math
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from reference.batches import grow, truth_of
from reference.settings import FEWEST_BATCHES, TRUTHS
from reference.store import Store
from reports import gate
from reports.compare import Truth, exposures_of
from reports.limits.detection import CAUGHT, INCONCLUSIVE, PASSED
from reports.progress import reporting
from reports.results import Row
from reports.rows import Picture, judged_rows
from reports.run.job import Job
from scenes.frame import Frame
from scenes.schema import Case
from scenes.suite import Entry

VERDICTS = {"fail": CAUGHT, "inconclusive": INCONCLUSIVE, "pass": PASSED, "reported": PASSED}
REMEMBERED = 2_000_000_000  # bytes of truths
# A row that passes by so many half widths of the whole pool's interval passes by every set. A set
# of a quarter of the pool has twice the half width, of local energy up to twice that, since few
# batches overstate it: at 4, one set of 300 was seen to be inconclusive, at 4.8 none.
FAR = 5.0


class Place(NamedTuple):
    """What a row is about."""

    pool: int
    object: str
    technique: str
    truth: str


@dataclass(frozen=True, eq=False)
class Pool:
    """The batches of a case: every truth of its model with a budget, and `global`."""

    entry: Entry
    batches: dict[str, list[Frame]]
    truths: tuple[str, ...]


def pools(job: Job, size: int) -> list[Pool]:
    """At least `size` batches of every reference of the case's model that has a budget."""
    judged = {rule.truth for rule in job.suite.budget} & set(TRUTHS["model"])
    entries = [e for e in job.entries if judged & set(e.truths)]
    sampling = job.suite.reference.model_copy(
        update={"max_samples": size * job.suite.reference.samples_per_batch}
    )
    made = []
    with reporting(len(entries)) as report:
        for entry in entries:
            report.step(f"{entry.case.id}: a pool of {size} batches")

            def traced(done: int, wanted: int, name: str = entry.case.id) -> None:
                report.detail(f"{name}: batch {done} of {wanted}")

            stored = grow(entry.case, "model", sampling, lambda _: False, Store(job.store), traced)
            truths = tuple(t for t in entry.truths if t in judged)
            batches = {t: [truth_of(b, t) for b in stored[:size]] for t in {*truths, "global"}}
            made.append(Pool(entry, batches, truths))
    return made


class Gate:
    """What `shadeproof gate` says of pictures of a job's cases, by batches of their pools.

    Attributes:
        looks: how many batches the gate may judge by, rising; the last is its cap.
    """

    def __init__(self, job: Job, pools: Sequence[Pool]) -> None:
        sampling = job.suite.reference
        most = max(sampling.max_samples // sampling.samples_per_batch, FEWEST_BATCHES)
        self.job, self.pools, self.looks = job, pools, [FEWEST_BATCHES]
        while self.looks[-1] < most:
            self.looks.append(min(2 * self.looks[-1], most))
        self.views: OrderedDict[tuple, tuple[Case, Truth]] = OrderedDict()
        self.remembered = 0

    def row(self, place: Place, frame: Frame, order: np.ndarray) -> Row:
        """One row, judged alone: the others may ask for batches, but undo no verdict."""
        for count in self.looks:
            view = self._view(place.pool, place.object, place.truth, order[:count])
            row = self._judged(view, place.technique, frame)[0]
            if gate.settled(row):
                break
        return row

    def budgeted(self, number: int, label: str, frames: Mapping[str, Frame]) -> dict[Place, Row]:
        """The rows of a technique that have a budget, by the whole pool; `frames` by truth."""
        everything = np.arange(len(self.pools[number].batches["global"]))
        rows = [
            row
            for truth, frame in frames.items()
            for row in self._judged(self._view(number, "", truth, everything), label, frame)
        ]
        return {Place(number, r.object, label, r.truth): r for r in rows if r.budget}

    def _judged(self, view: tuple[Case, Truth], label: str, frame: Frame) -> list[Row]:
        shown = {label: Picture(label, frame, view[0].model)}
        return judged_rows(*view, shown, {}, self.job.suite.budget, self.job.family)

    def _view(self, number: int, name: str, truth: str, taken: np.ndarray) -> tuple[Case, Truth]:
        """Some batches as a truth, and its case with one object judged, or all for "".

        A truth remembers what SSIM makes of it, which takes longer than judging a picture, and all
        sizes of all errors are judged by the same sets: those used last are kept.
        """
        if (at := (number, name, truth, tuple(taken))) in self.views:
            self.views.move_to_end(at)
            return self.views[at]
        pool = self.pools[number]
        case = pool.entry.case
        if name:
            kept = [o.model_copy(update={"judged": o.name == name}) for o in case.objects]
            case = case.model_copy(update={"objects": tuple(kept)})
        exposures = exposures_of(case, [pool.batches["global"][k] for k in taken])
        made = Truth(case, truth, [pool.batches[truth][k] for k in taken], exposures)
        self.views[at] = case, made
        self.remembered += _bytes(made)
        while self.remembered > REMEMBERED and len(self.views) > 1:
            _, (_, old) = self.views.popitem(last=False)
            self.remembered -= _bytes(old)
        return case, made


def _bytes(truth: Truth) -> int:
    """Bytes of a truth, with some 70 pictures that SSIM makes of it."""
    return sum(v.batches.nbytes + 70 * v.batches[0].nbytes for v in truth.views.values())


def clearance(row: Row) -> tuple[float, str]:
    """How far a row is over its budget, in half widths of the interval that verdicts take.

    Returns:
        That of the figure that is furthest over (below 0: least far within), and the figure. Above
        1 it fails, below -1 it passes.
    """
    if row.problem:
        return math.inf, row.problem
    return max((_clearance(row, figure), figure) for figure in row.budget)


def _clearance(row: Row, figure: str) -> float:
    value, limit = getattr(row, figure), row.budget[figure]
    low, high = gate.bounds(row, figure, row.confidence)
    if math.isnan(value):
        return math.inf  # which the gate fails
    if math.isnan(low):
        return 0.0  # unknown: near enough to be looked at
    if figure in gate.LOWER:
        over, width = limit - value, high - value if value < limit else value - low
    else:
        # Of a figure below zero the end far from zero is the other one.
        inner, outer = sorted((abs(low), abs(high)))
        over, width = abs(value) - limit, 0.0
        width = abs(value) - inner if over > 0 else outer - abs(value)
    return over / max(width, 1e-12)
