"""A logarithmic axis with round ends and few labels."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise

STEPS = (1, 2, 5, 10)
ROOM = 1.15  # between a value and the axis' end, as a factor


@dataclass(frozen=True)
class LogAxis:
    """From `low` to `high`, both above 0; places on it are percentages of its length."""

    low: float
    high: float

    @classmethod
    def around(cls, values: Iterable[float], least: float = 1.0) -> "LogAxis":
        """The axis, of `least` decades or more, with round ends around what is above 0.

        Values that are 0, negative or unknown have no place of their own on it.
        """
        placed = [v for v in values if 0 < v < math.inf] or [1.0]
        low, high = min(placed) / ROOM, max(placed) * ROOM
        short = max(least - math.log10(high / low), 0) / 2
        return cls(_round(low / 10**short, down=True), _round(high * 10**short, down=False))

    @property
    def decades(self) -> float:
        """Its length in powers of ten."""
        return math.log10(self.high / self.low)

    def at(self, value: float) -> float:
        """Where a value lies, in percent; what is beyond an end, 0 among it, lies at that end."""
        if value <= self.low:
            return 0.0
        place = 100 * math.log10(min(value, self.high) / self.low) / self.decades
        return round(place, 2)

    def ticks(self) -> list[float]:
        """Powers of ten, every second of more than 6; 2s and 5s too where decades are few."""
        first, last = math.floor(math.log10(self.low)), math.ceil(math.log10(self.high))
        steps = (1, 2, 5) if self.decades <= 2.3 else (1,)
        stride = 2 if self.decades > 6 else 1
        values = [s * 10.0**e for e in range(first, last + 1, stride) for s in steps]
        slack = 1 + 1e-9  # a power of ten is not always the float that one would write
        return [float(f"{v:.0e}") for v in values if self.low / slack <= v <= self.high * slack]

    def labelled(self, show: Callable[[float], str]) -> list[tuple[float, str]]:
        """Places and labels of the ticks."""
        return [(self.at(v), show(v)) for v in self.ticks()]


def _round(value: float, down: bool) -> float:
    """The next of 1, 2, 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(value))
    for below, above in pairwise(STEPS):
        if value < above * power * (1 - 1e-9):
            exact = math.isclose(value, below * power)
            return float(f"{(below if down or exact else above) * power:.0e}")
    return 10 * power
