"""The Pareto front: ways to draw that no other beats in both time and error."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

Standing = Literal["front", "near", "beaten"]


@dataclass(frozen=True)
class Measured:
    """A figure and its interval; both ends are NaN where the interval is unknown."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Way:
    """One way to draw: what it costs and how wrong it is, in any units; less is better."""

    cost: Measured
    error: Measured

    @property
    def known(self) -> bool:
        """Whether both figures are numbers."""
        return all(f.value == f.value for f in (self.cost, self.error))

    def beats(self, other: "Way") -> bool:
        """Whether it is at least as cheap and as right, and better in one of the two."""
        mine, its = (self.cost.value, self.error.value), (other.cost.value, other.error.value)
        return mine != its and all(a <= b for a, b in zip(mine, its, strict=True))

    def surely_beats(self, other: "Way") -> bool:
        """Whether it beats it wherever in the intervals the figures lie."""
        return (
            self.beats(other)
            and self.cost.high <= other.cost.low
            and self.error.high <= other.error.low
        )


def front(ways: Sequence[Way]) -> list[int]:
    """Indices of the ways that none beats, cheapest first; equal ones are all among them."""
    known = [i for i, way in enumerate(ways) if way.known]
    best = [i for i in known if not any(ways[k].beats(ways[i]) for k in known)]
    return sorted(best, key=lambda i: ways[i].cost.value)


def standings(ways: Sequence[Way]) -> list[Standing | None]:
    """Where each way stands: on the front, beaten, or `near`: beaten unless noise deceives.

    A way without both figures stands nowhere: None.
    """
    best = set(front(ways))

    def standing(i: int) -> Standing | None:
        if not ways[i].known:
            return None
        if i in best:
            return "front"
        return "beaten" if any(w.surely_beats(ways[i]) for w in ways) else "near"

    return [standing(i) for i in range(len(ways))]
