"""A case's trend over earlier runs: a line as small as a word (Tufte 2006, "sparkline")."""

from dataclasses import dataclass
from pathlib import Path

from reports.history import load_history, trends
from reports.html.figures import percent
from scenes.errors import InputError

SHOWN = 40  # runs
WIDE, HIGH = 120, 18  # of the drawing


@dataclass(frozen=True)
class Trend:
    """One line: its points as SVG, its last one, and what it says."""

    technique: str
    truth: str
    points: str
    last: tuple[float, float]
    words: str


def trends_of(folder: Path, suite: str) -> tuple[dict[str, list[Trend]], str]:
    """The trends of each case that has two runs or more, and what is wrong with the history."""
    try:
        found = trends(load_history(folder), suite)
    except InputError as error:
        return {}, str(error)
    made: dict[str, list[Trend]] = {}
    for (case, technique, truth), past in found.items():
        if len(past) > 1:
            made.setdefault(case, []).append(_trend(technique, truth, past[-SHOWN:]))
    return made, ""


def _trend(technique: str, truth: str, past: list[tuple[str, float]]) -> Trend:
    values = [value for _, value in past]
    low, high = min(values), max(values)
    # A tenth of the figure at least, or rounding would look like a landslide.
    room = max(high - low, 0.1 * high, 1e-9)
    middle = (low + high) / 2
    points = [
        (2 + (WIDE - 4) * i / (len(values) - 1), HIGH / 2 - (HIGH - 4) * (value - middle) / room)
        for i, value in enumerate(values)
    ]
    words = (
        f"local energy error of the worst object over {len(values)} runs since {past[0][0][:10]}: "
        f"{percent(values[0])} to {percent(values[-1])}, between {percent(low)} and {percent(high)}"
    )
    text = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return Trend(technique, truth, text, points[-1], words)
