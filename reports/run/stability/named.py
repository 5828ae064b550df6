"""Hard inputs of single functions, by name: what must hold, and what is measured."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from reports.stability.results import HardCase

Measured = dict[str, tuple[float, float]]  # by words: the figure, and the most that it may be


@dataclass(frozen=True)
class Named:
    """One hard input."""

    name: str
    must_hold: str
    why: str
    measure: Callable[[], Measured]

    def case(self) -> HardCase:
        """Measured and judged."""
        found = self.measure()
        return HardCase(
            name=self.name,
            kind="function",
            must_hold=self.must_hold,
            why=self.why,
            measured={words: figure for words, (figure, _) in found.items()},
            passed=all(figure <= most for figure, most in found.values()),
            command=f"shadeproof stability --hard {self.name}",
        )


def unfit(values: np.ndarray) -> float:
    """How many are NaN, Inf or negative."""
    return float((~(values >= 0) | np.isinf(values)).sum())
