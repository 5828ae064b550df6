"""The command that tells what changed between two runs."""

from pathlib import Path
from typing import Annotated

import typer

from reports.cli.app import app, console
from reports.cli.options import JsonOption


@app.command()
def diff(
    old: Annotated[Path, typer.Argument(help="The results.json of the earlier run.")],
    new: Annotated[Path, typer.Argument(help="That of the later one.")],
    json: JsonOption = False,
) -> None:
    """Tell what changed between two runs, row by row on the same references.

    Their frames are read beside them. Always ends with 0; `gate --regression` judges.
    """
    from reports.change.runs import changes_between
    from reports.change.told import print_changes
    from reports.results import load_results

    results = [load_results(path) for path in (old, new)]
    found = changes_between(results[0], old, results[1], new)
    if json:
        typer.echo(found.model_dump_json(indent=1))
    else:
        print_changes(found, console)
