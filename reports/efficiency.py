"""What a reference costs: time to an interval, beside the plain path tracer, in one run."""

import math
import statistics
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table

from reports.compare import Truth, compare, exposures_of
from reports.metrics import JUDGED
from scenes.frame import Frame
from scenes.schema import Case

# A judged figure by the field that holds its standard error. That of energy_local is of its
# square, whose ratio between two samplers is the same.
FIGURES = {"energy_error": "energy_se", "energy_local": "energy_local_se", "ssim": "ssim_se"}


@dataclass(frozen=True)
class Efficiency:
    """How much sooner one way to a reference reaches an interval than the plain way.

    An interval's width falls as 1/sqrt(time), so time to a given width goes as se² t.

    Attributes:
        se, plain_se: standard errors; NaN where noise hides the figure.
        seconds: of our one reference, for all of the case's truths at once.
        plain_seconds: of the plain way's, for this truth.
        plain_total: of the plain way's, for all truths.
    """

    case: str
    object: str
    truth: str
    figure: str
    se: float
    plain_se: float
    seconds: float
    plain_seconds: float
    plain_total: float

    @property
    def gain(self) -> float:
        """Plain time over ours to the same intervals of every truth of the case."""
        return self._fewer * self.plain_total / self.seconds

    @property
    def alone(self) -> float:
        """The same if this truth were all that is wanted, though ours gives the others too."""
        return self._fewer * self.plain_seconds / self.seconds

    @property
    def _fewer(self) -> float:
        """How many times fewer samples; NaN where noise hides the figure on either side."""
        return (self.plain_se / self.se) ** 2


def efficiencies(
    case: Case,
    candidate: Frame,
    ours: dict[str, list[Frame]],
    plain: dict[str, list[Frame]],
    pilot: float,
) -> Iterator[Efficiency]:
    """The gain in each judged figure of each object, for each truth.

    Args:
        ours, plain: batches by truth, as many of each and of as many samples; `seconds` of ours
            are of all truths together.
        pilot: seconds that ours takes before its first batch.
    """
    exposures = exposures_of(case, ours["global"])
    total = sum(b.seconds for batches in plain.values() for b in batches)
    for truth, batches in ours.items():
        with_ids = [replace(f, ids=batches[0].ids) for f in plain[truth]]
        views = [Truth(case, truth, b, exposures) for b in (batches, with_ids)]
        found = [
            {o.name: compare(case, o, candidate, view, JUDGED) for o in case.judged}
            for view in views
        ]
        for obj in case.judged:
            for figure, noise in FIGURES.items():
                se, plain_se = (f[obj.name].get(noise, math.nan) for f in found)
                seconds = pilot + sum(b.seconds for b in batches)
                others = sum(b.seconds for b in plain[truth])
                yield Efficiency(
                    case.id, obj.name, truth, figure, se, plain_se, seconds, others, total
                )


def print_efficiencies(found: list[Efficiency], console: Console) -> None:
    """One line per object and truth, and the medians."""
    table = Table(box=box.SIMPLE_HEAD)
    for heading in ("case", "object", "truth", *FIGURES):
        table.add_column(heading, justify="right" if heading in FIGURES else "left")
    by_row: dict[tuple[str, str, str], dict[str, float]] = {}
    for e in found:
        by_row.setdefault((e.case, e.object, e.truth), {})[e.figure] = e.gain
    for row, gains in by_row.items():
        table.add_row(*row, *(f"{gains[f]:.1f}" for f in FIGURES))
    for truth in dict.fromkeys(e.truth for e in found):
        medians = [
            median(e.gain for e in found if (e.truth, e.figure) == (truth, f)) for f in FIGURES
        ]
        table.add_row("median", "", truth, *(f"{m:.1f}" for m in medians))
    console.print(
        "Time of plain path tracing over ours, to the same intervals. The plain way renders each "
        "truth apart, ours traces all three at once: each row is charged with all three, on both "
        "sides."
    )
    console.print(table)
    low, high = bootstrapped(found)
    console.print(f"median of all: {median(e.gain for e in found):.1f} ({low:.1f} to {high:.1f})")
    hidden = sum(math.isnan(e.plain_se) and not math.isnan(e.se) for e in found)
    console.print(f"left out: {hidden} figures that only the plain way's noise hides")
    for truth in dict.fromkeys(e.truth for e in found):
        strict = median(e.alone for e in found if e.truth == truth)
        console.print(f"if `{truth}` were all that is wanted: {strict:.2f}")


def bootstrapped(found: list[Efficiency], seed: int = 0) -> tuple[float, float]:
    """95 % bounds of the median gain, by drawing objects anew (Efron 1979)."""
    by_object: dict[tuple[str, str], list[float]] = {}
    for e in found:
        by_object.setdefault((e.case, e.object), []).append(e.gain)
    groups, rng = list(by_object.values()), np.random.default_rng(seed)
    medians = [
        median(g for k in rng.integers(len(groups), size=len(groups)) for g in groups[k])
        for _ in range(1000)
    ]
    return tuple(np.nanpercentile(medians, [2.5, 97.5]))


def median(gains: Iterable[float]) -> float:
    """Of those that can be told."""
    known = [g for g in gains if not math.isnan(g)]
    return statistics.median(known) if known else math.nan
