"""report.html: a page that shows a run, offline and worst first."""

import json
import os
import secrets
import shutil
from collections.abc import Iterable
from pathlib import Path

from reports.html.layers import Layer
from reports.html.page import page_of
from reports.html.template import render
from reports.results import Results
from scenes.frame import unwritable, write_text

LARGEST = 25e6  # bytes of a page that holds its pictures itself
BESIDE = "report_files"


def write_report(results: Results, folder: Path) -> Path:
    """Write `folder`/report.html whole or not at all; its path.

    It is one file, unless that were larger than LARGEST: then the pictures lie beside it in the
    folder BESIDE, and are read when they are looked at.

    Args:
        folder: holds the EXRs at the paths that `results.cases` name; a picture that is not
            there is shown as a missing picture. What other commands left in it, a
            bench.json, stability.json, attack.json or limits.json, is shown too.

    Raises:
        InputError: the folder cannot be written.
    """
    path, beside = folder / "report.html", folder / BESIDE
    page = page_of(results, folder)
    text = render("report.html.j2", page=page, beside="")
    if len(text.encode()) > LARGEST:
        _write_layers(page.layers, beside)
        text = render("report.html.j2", page=page, beside=BESIDE)
    else:
        shutil.rmtree(beside, ignore_errors=True)
    write_text(path, text)
    return path


def _write_layers(layers: Iterable[Layer], folder: Path) -> None:
    """A script for each layer, which a page may read where it may not read a file."""
    aside = folder.with_name(f".{secrets.token_hex(4)}-{folder.name}")
    try:
        aside.mkdir(parents=True)
        for layer in layers:
            call = f"shadeproof.layer({json.dumps(layer.id)}, {json.dumps(layer.data)});\n"
            (aside / f"{layer.id}.js").write_text(call, encoding="utf-8")
        shutil.rmtree(folder, ignore_errors=True)
        os.replace(aside, folder)
    except OSError as error:
        shutil.rmtree(aside, ignore_errors=True)
        raise unwritable(folder, "", error) from error
