"""Where the shaders keep their promises: stability.html, and the same section in report.html."""

from pathlib import Path

from reports.html.stability.view import StabilityView, stability_view
from reports.html.template import render
from reports.stability.results import Stability, load_stability
from scenes.errors import InputError
from scenes.frame import write_text

__all__ = ["StabilityView", "stability_of", "write_page"]


def write_page(found: Stability, folder: Path) -> Path:
    """Write `folder`/stability.html whole or not at all; its path.

    Raises:
        InputError: the folder cannot be written.
    """
    path = folder / "stability.html"
    write_text(
        path, render("stability.html.j2", created=found.created, shown=stability_view(found))
    )
    return path


def stability_of(folder: Path) -> StabilityView | str | None:
    """What `folder`/stability.json shows; why it cannot be shown; None where there is none."""
    path = folder / "stability.json"
    if not path.exists():
        return None
    try:
        return stability_view(load_stability(path))
    except InputError as error:
        return str(error)
