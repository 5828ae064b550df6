"""report.html: one file that shows a run, offline and worst first."""

from functools import cache
from pathlib import Path

import jinja2
from markupsafe import Markup

from reports.html.page import page_of
from reports.results import Results
from scenes.frame import write_text

HERE = Path(__file__).parent


def write_report(results: Results, folder: Path) -> Path:
    """Write `folder`/report.html whole or not at all; its path.

    Args:
        folder: holds the EXRs at the paths that `results.cases` name; a picture that is not
            there is shown as a missing picture.

    Raises:
        InputError: the folder cannot be written.
    """
    html = _template().render(
        page=page_of(results, folder),
        css=Markup((HERE / "report.css").read_text(encoding="utf-8")),
        js=Markup((HERE / "report.js").read_text(encoding="utf-8")),
    )
    path = folder / "report.html"
    write_text(path, html)
    return path


@cache
def _template() -> jinja2.Template:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("report.html.j2")
