"""Frame time beside path tracing, as a ratio within one run."""

from dataclasses import dataclass

from rich import box
from rich.console import Console
from rich.table import Table


@dataclass(frozen=True)
class Timing:
    """One technique on one case, beside one sample per pixel of Mitsuba at the same size.

    Attributes:
        frame_seconds: median of warm frames.
        precomputation_seconds: all maps of the environment.
        sample_seconds: median of warm path-traced pictures at 1 sample per pixel.
    """

    case: str
    width: int
    height: int
    technique: str
    frame_seconds: float
    precomputation_seconds: float
    sample_seconds: float

    @property
    def ratio(self) -> float:
        """Frame time over the time of one path-traced sample per pixel."""
        return self.frame_seconds / self.sample_seconds


def print_timings(timings: list[Timing], console: Console) -> None:
    """One line per case and technique."""
    table = Table(box=box.SIMPLE_HEAD)
    for heading in ("case", "size", "technique"):
        table.add_column(heading)
    for heading in ("frame", "Mitsuba, 1 sample", "ratio", "precomputation"):
        table.add_column(heading, justify="right")
    for t in timings:
        table.add_row(
            t.case,
            f"{t.width}x{t.height}",
            t.technique,
            f"{t.frame_seconds * 1e3:.1f} ms",
            f"{t.sample_seconds * 1e3:.1f} ms",
            f"{t.ratio:.3f}",
            f"{t.precomputation_seconds:.2f} s",
        )
    console.print(table)
