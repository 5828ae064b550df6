"""One error of some sign: what the gate sees of it by size."""

import math
from collections import Counter
from dataclasses import replace
from functools import cache

import numpy as np

from reports.limits.detection import CAUGHT, INCONCLUSIVE, PASSED, SHARE, Curve, noiseless, traced
from reports.limits.known_errors import KnownError
from reports.limits.results import EVERY, Limit, Point
from reports.results import Row
from reports.run.limits.judging import FAR, VERDICTS, Gate, Place, clearance
from reports.run.shots import Shot, shots
from scenes.frame import Frame


class Seen:
    """What the gate sees of one error. Whatever was found is remembered.

    Args:
        gate: says verdicts.
        orders: (sets, M) the batches of each set.
        error, sign: what is wrong, and which way.
    """

    def __init__(self, gate: Gate, orders: np.ndarray, error: KnownError, sign: int) -> None:
        self.gate, self.orders, self.error, self.sign = gate, orders, error, sign
        self.frames: dict[tuple[float, int, str], Frame] = {}
        self.screened: dict[tuple[float, str], dict[Place, Row]] = {}
        self.without_noise: dict[str, float | None] = {}
        self.verdicts: dict[tuple[float, Place, int], int] = {}

    def frame(self, size: float, number: int, label: str, truth: str) -> Frame:
        """The wrong picture of a case that stands against a truth."""
        right = self.gate.pools[number].entry.case
        shot = shots(label, right, (truth,), timed=False)[truth]
        if (at := (size, number, shot.name)) not in self.frames:
            case = self.error.case(right, self.sign * size)
            drawn = _drawn_right(shot) if case is right else _drawn(replace(shot, case=case))
            self.frames[at] = replace(drawn, rgb=self.error.picture(drawn.rgb, self.sign * size))
        return self.frames[at]

    def _against(self, size: float, number: int, label: str) -> dict[str, Frame]:
        truths = self.gate.pools[number].truths
        return {truth: self.frame(size, number, label, truth) for truth in truths}

    def rows(self, size: float, label: str) -> dict[Place, Row]:
        """Every row of a technique that has a budget, by the whole pool."""
        if (at := (size, label)) not in self.screened:
            self.screened[at] = {
                place: row
                for number, pool in enumerate(self.gate.pools)
                if label in pool.entry.techniques
                for place, row in self.gate.budgeted(
                    number, label, self._against(size, number, label)
                ).items()
            }
        return self.screened[at]

    def noiseless(self, label: str) -> float | None:
        """The size from which a figure of a technique is over its budget, whatever its interval."""

        def over(size: float) -> float:
            rows = self.rows(size, label).values()
            return max((clearance(row)[0] for row in rows), default=-math.inf)

        if label not in self.without_noise:
            self.without_noise[label] = noiseless(over, self.error.largest)
        return self.without_noise[label]

    def sets(self, size: float, labels: list[str], asked: slice = slice(None)) -> np.ndarray:
        """The outcomes of sets: of each row that could make it worse, worst row first.

        A row that the whole pool has within its budget could only make it inconclusive: against
        its failing stand more than four standard errors.
        """
        rows = {p: clearance(r)[0] for label in labels for p, r in self.rows(size, label).items()}
        near = sorted((p for p in rows if rows[p] > -FAR), key=rows.get, reverse=True)
        numbers = np.arange(len(self.orders))[asked]
        outcomes = np.full(len(numbers), PASSED)
        for place in near:
            frame = self.frame(size, place.pool, place.technique, place.truth)
            most = CAUGHT if rows[place] > 0 else INCONCLUSIVE
            for k in np.flatnonzero(outcomes < most):
                if (at := (size, place, number := numbers[k])) not in self.verdicts:
                    row = self.gate.row(place, frame, self.orders[number])
                    self.verdicts[at] = VERDICTS[row.verdict]
                outcomes[k] = max(outcomes[k], self.verdicts[at])
        return outcomes

    def limit(self, labels: list[str]) -> Limit:
        """The smallest size that rows of these techniques catch."""
        found = min(filter(None, map(self.noiseless, labels)), default=None)
        start = found or self.error.largest
        curve = traced(
            lambda *asked: self.sets(asked[0], labels, asked[1]), start, self.error.largest
        )
        taken, pool = self.gate.looks[-1], self.orders.shape[1]
        smallest, low, high = curve.limit(taken, pool)
        by = self._seen_by(curve, labels)
        made = Limit(
            parameter=self.error.parameter,
            unit=self.error.unit,
            sign="+" if self.sign > 0 else "-",
            technique=labels[0] if len(labels) == 1 else EVERY,
            smallest=smallest,
            low=low,
            high=high,
            noiseless=found,
            curve=[_point(size, curve) for size in curve.sizes],
            seen_by="",
            limited_by=_limited_by(smallest, found),
            words="",
        )
        if by is None:
            return made.model_copy(update={"words": _unseen(self.error.largest, found)})
        place, figure = by
        row = self.rows(0.0, place.technique)[place]
        seen_by = f"{place.technique} vs {place.truth}, {place.object} in {row.case}: {figure}"
        return made.model_copy(update={"seen_by": seen_by, "words": _words(made, row, figure)})

    def _seen_by(self, curve: Curve, labels: list[str]) -> tuple[Place, str] | None:
        """The row that most sets see it by at the least size that is caught, and its figure."""
        often = [size for size in curve.sizes if curve.share(size) >= SHARE]
        if not often:
            return None
        seen = Counter(
            place
            for (size, place, _), verdict in self.verdicts.items()
            if size == often[0] and verdict == CAUGHT and place.technique in labels
        )
        place, _ = seen.most_common(1)[0]
        return place, clearance(self.rows(often[0], place.technique)[place])[1]


def _drawn(shot: Shot) -> Frame:
    return shot.candidate.render(shot.case)


_drawn_right = cache(_drawn)  # for errors of the picture alone


def _point(size: float, curve: Curve) -> Point:
    outcomes = curve.outcomes[size]
    caught, unsure = (int((outcomes == o).sum()) for o in (CAUGHT, INCONCLUSIVE))
    return Point(size=size, caught=caught, inconclusive=unsure, of=len(outcomes))


def _limited_by(smallest: float | None, noiseless: float | None) -> str:
    """Whether most of a limit is what a reference without noise would leave of it."""
    if noiseless is None or (smallest is not None and noiseless >= smallest / 2):
        return "budget"
    return "noise"


def _unseen(largest: float, noiseless: float | None) -> str:
    if noiseless is None:
        return f"up to {largest:g} no figure leaves its budget"
    return f"up to {largest:g} it is hidden by noise; without noise {noiseless:.2g} would be caught"


def _words(limit: Limit, row: Row, figure: str) -> str:
    """What a right renderer leaves of the budget, and what the noise adds."""
    own = "fails"
    if figure in row.budget:
        own = f"{figure} is {getattr(row, figure):.3g} of {row.budget[figure]:g} without the error"
    if limit.noiseless is None:
        return own
    added = max(limit.smallest - limit.noiseless, 0.0)
    return f"{own}; the budget's slack hides {limit.noiseless:.2g}, noise {added:.2g} more"
