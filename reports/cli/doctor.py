"""The command that says in words what is wrong with an outside renderer."""

from pathlib import Path
from typing import Annotated

import typer

from reports.cli.app import app, console, when_interrupted
from reports.cli.options import TimeoutOption
from scenes.errors import InputError


@app.command()
def doctor(
    candidate: Annotated[
        str,
        typer.Option(
            help="Whom to examine: a command with {case} and {out}, or a folder of EXRs drawn "
            "from --cases."
        ),
    ] = "",
    cases: Annotated[
        Path | None,
        typer.Option(help="Write the doctor's cases here as JSON, with their files, and stop."),
    ] = None,
    timeout: TimeoutOption = 600,
) -> None:
    """Say in words what is wrong with an outside renderer: light, view, normals, materials.

    Four small cases are drawn. Ends with 1 where something is wrong.
    """
    from reports.candidates import outside_candidate
    from reports.doctor.told import print_diagnosis
    from reports.run.doctor import examine, write_cases

    if bool(candidate) == bool(cases):
        raise InputError("--candidate, --cases", "", "give one of the two", "see doctor --help")
    if cases:
        for path in write_cases(cases):
            typer.echo(path)
        return
    when_interrupted.append("nothing is kept")
    found = examine(outside_candidate(candidate, timeout))
    print_diagnosis(found, console)
    raise typer.Exit(0 if found.sound else 1)
