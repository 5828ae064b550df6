"""What came of evaluating points again: every side's numbers, and figures held to limits."""

import math
from dataclasses import dataclass, field

import numpy as np

Told = tuple[str, np.ndarray]  # what, and its numbers


@dataclass(frozen=True)
class Judged:
    """One figure, and what it may be; without a limit it passes if it is a number.

    Attributes:
        words: what it is, with its unit.
    """

    words: str
    value: float
    limit: float | None = None
    at_least: float = -math.inf

    @property
    def passed(self) -> bool:
        """Whether it is within what it may be; NaN never is."""
        if self.limit is None:
            return math.isfinite(self.value)
        return self.at_least <= self.value <= self.limit


@dataclass(frozen=True)
class Answer:
    """What the sides make of a point, or of a step between two."""

    sides: list[Told]
    figures: list[Judged] = field(default_factory=list)

    @property
    def passed(self) -> bool:
        """Whether every figure is."""
        return all(f.passed for f in self.figures)
