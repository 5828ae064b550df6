"""The command that writes cases for other programs."""

from pathlib import Path
from typing import Annotated

import typer

from reports.cli.app import app, console
from reports.cli.options import takes_job


@app.command()
@takes_job("suite", "filter")
def export(
    job,
    to: Annotated[Path, typer.Option("--to", help="The folder for the zips, one a case.")],
) -> None:
    """Write cases as zips that draw them elsewhere: JSON, glTF 2.0, EXR and Mitsuba's XML."""
    from reports.run.export import export as write

    for path, lacks in write(job, to):
        console.print(f"{path}{f' ({lacks})' if lacks else ''}", soft_wrap=True, markup=False)
