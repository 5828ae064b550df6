"""The ways of one case, timed together and held against its truth."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from reports.compare import Truth
from reports.run.bench.errors import Judged, error_of, judged
from reports.run.bench.way import Way
from reports.speed.points import Point, Timed, case_digest
from scenes.schema import Case

PICTURES = 3  # of different seeds, whose errors are measured
WARMING = 0.1  # seconds: before a shorter frame one more is drawn, since another way's was the last


@dataclass
class Measured:
    """One way and what was measured of it.

    Attributes:
        seconds: of its frame in each round.
        judged: by object, the figures of one picture, or of several seeds.
    """

    way: Way
    seconds: list[float] = field(default_factory=list)
    judged: dict[str, list[Judged]] = field(default_factory=dict)

    def problems(self) -> list[tuple[str, str]]:
        """Objects whose errors are missing, with the reason."""
        found = {(o, _why(j)) for o, pictures in self.judged.items() for j in pictures}
        return sorted((o, why) for o, why in found if why)

    def point(self, case: Case, gpu: list[float]) -> Point:
        """The record of it; its costs are measured now."""
        frame, way = timed(self.seconds), self.way
        cost = way.cost(frame.median)
        return Point(
            case=case.id,
            digest=case_digest(case),
            environment=case.environment.name,
            width=case.width,
            height=case.height,
            family=way.family,
            name=way.name,
            samples=way.samples,
            frame=frame,
            gpu=timed(gpu) if gpu else None,
            compilation=cost.compilation,
            precomputation=cost.precomputation,
            preparation=cost.preparation,
            after=cost.after,
            memory=cost.memory,
            held=cost.held,
            errors=[error_of(obj, self.judged[obj.name]) for obj in case.judged],
        )


def _why(picture: Judged) -> str:
    """Why figures of a picture are missing, if any."""
    figures = {"local energy": picture.local_square, "SSIM": picture.one_minus_ssim}
    unknown = [name for name, estimate in figures.items() if math.isnan(estimate.value)]
    if picture.problem or not unknown:
        return picture.problem
    return f"{' and '.join(unknown)} unknown: the truth is black or too noisy"


def lacking(case: Case, measured: Sequence[Measured]) -> list[str]:
    """A line per object and reason for which errors are missing, with the ways it holds for."""
    found: dict[tuple[str, str], list[str]] = {}
    for m in measured:
        for problem in m.problems():
            found.setdefault(problem, []).append(m.way.name)
    return [
        f"{case.id}, errors of {name}: {problem}"
        + ("" if len(ways) == len(measured) else f" ({', '.join(ways)})")
        for (name, problem), ways in found.items()
    ]


def timed(seconds: Sequence[float]) -> Timed:
    """Median and quartiles."""
    low, middle, high = np.percentile(seconds, (25, 50, 75))
    return Timed(median=middle, low=low, high=high, frames=len(seconds))


def measure(
    case: Case, ways: list[Way], truth: Truth, rounds: int, told: Callable[[str], None]
) -> list[Measured]:
    """Time every way once a round, and judge its pictures.

    In rounds, so that a machine that slows down slows them all, and each round starts with
    another way. Serial and warm: each way has drawn a frame before, and before a short frame it
    draws one more, whose predecessor left the caches to others.

    Args:
        told: called with what is being done.
    """
    found = [Measured(way) for way in ways]
    for m in found:
        told(f"warm up {m.way.name}")
        m.way.frame(0)
    for number in range(rounds):
        told(f"round {number + 1} of {rounds}")
        first = number % len(found)
        for place, m in enumerate(found[first:] + found[:first]):
            # Every way and round has a seed of its own, the same in every run.
            seed = 1 + number * len(found) + (first + place) % len(found)
            if not m.seconds or m.seconds[-1] < WARMING:
                m.way.frame(seed)
            m.seconds.append(m.way.frame(seed))
            if number < (PICTURES if m.way.noisy else 1):
                picture = m.way.picture()
                for obj in case.judged:
                    own = m.judged.setdefault(obj.name, [])
                    own.append(judged(case, obj, picture, truth))
    return found
