"""Templates to pages: one look, and nothing asked of the network."""

import re
from functools import cache
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup

from reports.html.numbers import prose

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
STYLES = "report.css", "viewer.css", "attack.css", "stability.css"
SCRIPTS = "packing.js", "painting.js", "loading.js", "viewer.js"
SCRIPTS += "finder.js", "report.js", "atlas.js"


def render(template: str, **shown: Any) -> str:
    """A page as HTML, with the style and the script that all pages share."""
    return (
        _environment()
        .get_template(template)
        .render(
            css=_joined(STYLES),
            js=_joined(SCRIPTS),
            **shown,
        )
    )


def pasted(text: str) -> str:
    """A command, or a sentence with one in backticks, as it runs where this is installed.

    In a checkout `make` leaves the program in .venv and on no PATH.
    """
    if not (ROOT / "Makefile").is_file():
        return text
    return re.sub(r"(^|`)shadeproof(?= )", r"\1.venv/bin/shadeproof", text)


def _joined(names: tuple[str, ...]) -> Markup:
    return Markup("\n".join((HERE / name).read_text(encoding="utf-8") for name in names))


@cache
def _environment() -> jinja2.Environment:
    made = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters |= {"pasted": pasted, "prose": prose}
    return made
