"""Figures as people read them: a unit on each, a dash where there is none."""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass

from reports.results import Row

NONE = "–"
GAP = "\u202f"  # narrow no-break space


def number(value: float, decimals: int, signed: bool = False) -> str:
    """A number with a true minus sign; a dash for NaN, ∞ for infinity."""
    if math.isnan(value):
        return NONE
    if math.isinf(value):
        return "−∞" if value < 0 else "∞"
    text = f"{value:{'+' if signed else ''}.{decimals}f}"
    return text.replace("-", "−")


def percent(value: float, signed: bool = False, decimals: int | None = None) -> str:
    """A fraction in percent, to three digits."""
    if decimals is None:
        decimals = _decimals(value)
    text = number(100 * value, decimals, signed)
    return text if text == NONE else f"{text}{GAP}%"


def similarity(value: float, decimals: int = 4) -> str:
    """An SSIM."""
    return number(value, decimals)


def digits(value: float) -> str:
    """A number to three digits, never with an exponent, without idle zeros."""
    if not math.isfinite(value) or value == 0:
        return number(value, 0)
    decimals = max(2 - math.floor(math.log10(abs(value))), 0)
    text = f"{round(value, decimals):,.{decimals}f}".replace(",", GAP).replace("-", "−")
    return text.rstrip("0").rstrip(".") if "." in text else text


def seconds(value: float) -> str:
    """A time in seconds, in the unit that suits it."""
    if not math.isfinite(value):
        return number(value, 0)
    if value < 0.9995:
        return f"{digits(1e3 * value)}{GAP}ms"
    if value < 120:
        return f"{digits(value)}{GAP}s"
    return f"{digits(value / 60)}{GAP}min"


def size(value: float) -> str:
    """Bytes in the unit that suits them."""
    if not math.isfinite(value):
        return number(value, 0)
    unit, name = (1e9, "GB") if value >= 999.5e6 else (1e6, "MB")
    return f"{digits(value / unit)}{GAP}{name}"


def count(value: float) -> str:
    """A whole number with its thousands apart."""
    return f"{value:,}".replace(",", GAP)


def half_width(interval: tuple[float, float]) -> float:
    """Half of a 95 % interval; NaN where noise cannot be told."""
    return (interval[1] - interval[0]) / 2


def within(shown: str, interval: tuple[float, float], show: Callable[[float], str]) -> str:
    """A figure that nobody judges, with its interval where it has one."""
    low, high = interval
    if shown == NONE or math.isnan(low):
        return shown
    return f"{shown} ({show(low)} to {show(high)})"


def slug(*parts: str) -> str:
    """An HTML id from names, whatever they hold."""
    return "--".join(re.sub(r"[^\w.=-]+", "-", part) for part in parts)


@dataclass(frozen=True)
class Metric:
    """A figure that can have a budget.

    Attributes:
        name: the field of Row.
        interval: the field with its interval, if it has one.
        label: as in a heading.
        budget_label: as in 'misses its ... budget'.
        limit: how its budget reads, with {} for the figure.
    """

    name: str
    interval: str
    label: str
    budget_label: str
    limit: str
    show: Callable[[float], str]

    def value(self, row: Row) -> float:
        """The figure."""
        return getattr(row, self.name)

    def bounds(self, row: Row) -> tuple[float, float]:
        """Its interval; NaN where it has none."""
        return getattr(row, self.interval) if self.interval else (math.nan, math.nan)

    def spread(self, row: Row) -> str:
        """Half the interval, to as many decimals as the figure; 'unknown' where noise hides it.

        Empty where the figure has no interval, or where there is no figure.
        """
        half = half_width(self.bounds(row))
        if not math.isfinite(half):
            return f"±{GAP}unknown" if self.hidden(row) else ""
        if self.name == "ssim":
            return f"±{GAP}{similarity(half)}"
        # As many decimals as the figure, and more where they would say that there is no noise.
        decimals = max(_decimals(self.value(row)), _first_decimal(half))
        return f"±{GAP}{percent(half, decimals=decimals)}"

    def hidden(self, row: Row) -> str:
        """Why a figure that there is has no interval; empty where it has one."""
        known = math.isfinite(half_width(self.bounds(row)))
        if not self.interval or known or not math.isfinite(self.value(row)):
            return ""
        few = {1: "one batch has no spread", 2: "an interval takes three batches"}
        return few.get(row.reference_batches, "the reference's noise hides it")

    def allowed(self, limit: float) -> str:
        """The budget, as '≤ 20 %' or '≥ 0.97'."""
        shown = f"{limit:g}" if self.limit.startswith("≥") else f"{100 * limit:g}{GAP}%"
        return self.limit.format(shown)

    def bare(self, limit: float) -> str:
        """The budget without its sign, as '20 %' or '0.97'."""
        return self.allowed(limit).split(GAP, 1)[1]

    def undecided(self, row: Row) -> bool:
        """Whether noise hides on which side of its budget the figure lies."""
        return self.name in row.undecided


METRICS = {
    metric.name: metric
    for metric in (
        Metric("energy_local", "energy_local_ci95", "Local energy error", "local energy",
               f"≤{GAP}{{}}", percent),
        Metric("energy_error", "energy_ci95", "Total energy error", "total energy",
               f"within ±{GAP}{{}}", lambda v: percent(v, signed=True)),
        Metric("ssim", "ssim_ci95", "SSIM", "SSIM", f"≥{GAP}{{}}", similarity),
        Metric("silhouette", "", "Silhouette", "silhouette", f"≥{GAP}{{}}", similarity),
    )
}  # fmt: skip


def decisive(row: Row) -> str:
    """The budgeted metric that gives a row its verdict; empty where there is none.

    The one with the smallest margin; but one without a figure where no other misses its budget,
    and in an inconclusive row one of those that noise hides.
    """
    known = {n: m for n, m in row.margins.items() if n in METRICS and not math.isnan(m)}
    if row.verdict == "inconclusive":
        known = {n: m for n, m in known.items() if METRICS[n].undecided(row)} or known
    worst = min(known, key=known.__getitem__, default="")
    lost = [n for n in METRICS if n in row.budget and math.isnan(METRICS[n].value(row))]
    if row.verdict == "fail" and lost and known.get(worst, 0) >= 0:
        return lost[0]
    return worst


def _decimals(value: float) -> int:
    """Decimals of a percentage that leave three digits."""
    size = abs(100 * value)
    return 0 if size >= 100 else 1 if size >= 10 else 2


def _first_decimal(value: float) -> int:
    """The decimal in which the first digit of a percentage stands, at most the fourth."""
    return min(max(-math.floor(math.log10(100 * value)), 0), 4) if value > 0 else 0
