"""report.html: one file that shows a run, offline and worst first."""

from pathlib import Path

from reports.html.page import page_of
from reports.html.template import render
from reports.results import Results
from scenes.frame import write_text


def write_report(results: Results, folder: Path) -> Path:
    """Write `folder`/report.html whole or not at all; its path.

    Args:
        folder: holds the EXRs at the paths that `results.cases` name; a picture that is not
            there is shown as a missing picture. What other commands left in it, a
            bench.json, stability.json, attack.json or limits.json, is shown too.

    Raises:
        InputError: the folder cannot be written.
    """
    path = folder / "report.html"
    write_text(path, render("report.html.j2", page=page_of(results, folder)))
    return path
