"""Speed against error: bench.html, and the same section in report.html."""

from pathlib import Path

from reports.html.speed.view import SpeedView, speed_view
from reports.html.template import render
from reports.speed.points import Bench, load_bench
from scenes.errors import InputError
from scenes.frame import write_text

__all__ = ["SpeedView", "speed_of", "write_page"]


def write_page(bench: Bench, folder: Path) -> Path:
    """Write `folder`/bench.html whole or not at all; its path.

    Raises:
        InputError: the folder cannot be written.
    """
    path = folder / "bench.html"
    write_text(path, render("bench.html.j2", bench=bench, speed=speed_view(bench)))
    return path


def speed_of(folder: Path) -> SpeedView | str | None:
    """What `folder`/bench.json shows; why it cannot be shown; None where there is none."""
    path = folder / "bench.json"
    if not path.exists():
        return None
    try:
        return speed_view(load_bench(path))
    except InputError as error:
        return str(error)
