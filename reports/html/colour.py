"""Colour scales of the maps: fixed limits, so that any two maps can be compared by eye."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

NOT_A_NUMBER = (255, 0, 255)  # magenta stands in neither scale


def ramp(stops: Sequence[str], steps: int) -> np.ndarray:
    """Colours (steps, 3) uint8 sRGB evenly along stops, each #rrggbb."""
    known = np.array([[int(s[i : i + 2], 16) for i in (1, 3, 5)] for s in stops])
    at = np.linspace(0, len(known) - 1, steps)
    channels = [np.interp(at, np.arange(len(known)), known[:, c]) for c in range(3)]
    return np.round(np.stack(channels, axis=1)).astype(np.uint8)


@dataclass(frozen=True)
class Scale:
    """Values from `low` to `high` in equal steps of colour; beyond them the end colours.

    Attributes:
        stops: sRGB colours as #rrggbb, evenly spaced.
        steps: how many colours a map has; odd, so that the middle has one of its own.
        ticks: what the legend's ends and middle say.
    """

    low: float
    high: float
    steps: int
    stops: tuple[str, ...]
    ticks: tuple[str, str, str]

    @cached_property
    def colours(self) -> np.ndarray:
        """(steps, 3) uint8 sRGB."""
        return ramp(self.stops, self.steps)

    @property
    def gradient(self) -> str:
        """The legend's bar, as a CSS image."""
        return f"linear-gradient(to right, {', '.join(self.stops)})"

    def indices(self, values: np.ndarray) -> np.ndarray:
        """The step of each value, (...) uint8; NaN gives 0 and has to be masked."""
        share = (np.nan_to_num(values, nan=self.low) - self.low) / (self.high - self.low)
        return np.round(np.clip(share, 0, 1) * (self.steps - 1)).astype(np.uint8)

    def places(self, values: np.ndarray, inside: np.ndarray) -> np.ndarray:
        """Places (h, w) uint8 in `palette`."""
        places = self.indices(values) + np.uint8(2)
        places[~np.isfinite(values)] = 1
        places[~inside] = 0
        return places

    @property
    def palette(self) -> list[tuple[int, int, int]]:
        """What is outside, what is no number, and the steps."""
        return [(0, 0, 0), NOT_A_NUMBER, *map(tuple, self.colours.tolist())]


# ColorBrewer's RdBu turned round (Brewer 2002): safe for colour-blind readers, white in the middle.
SIGNED = Scale(
    low=-0.25,
    high=0.25,
    steps=51,  # one for each percent
    stops=(
        "#053061", "#2166ac", "#4393c3", "#92c5de", "#d1e5f0", "#f7f7f7",
        "#fddbc7", "#f4a582", "#d6604d", "#b2182b", "#67001f",
    ),
    ticks=("−25 % or less", "0", "+25 % or more"),
)  # fmt: skip

# Cividis in five stops (Nuñez, Anderton and Renslow 2018): even in lightness, colour-blind safe.
SIMILARITY = Scale(
    low=0,
    high=1,
    steps=101,
    stops=("#00224e", "#414d6b", "#7c7b78", "#bcaf6f", "#fde737"),
    ticks=("0 or less", "0.5", "1 same"),
)

# Magma in six stops (van der Walt and Smith 2015), as the tool that comes with FLIP shows it.
ERROR = Scale(
    low=0,
    high=1,
    steps=101,
    stops=("#000004", "#3b0f70", "#8c2981", "#de4968", "#fe9f6d", "#fcfdbf"),
    ticks=("0 same", "0.5", "1"),
)
