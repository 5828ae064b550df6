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


@app.command()
def brdf(
    candidate: Annotated[
        str, typer.Option(help="A command with {case} and {out}, called with a list of directions.")
    ],
    material: Annotated[
        list[str] | None, typer.Option(help="A material by name; may be repeated.")
    ] = None,
    model: Annotated[str, typer.Option(help="The model: paper or physical.")] = "paper",
    timeout: TimeoutOption = 600,
) -> None:
    """Check a BRDF from outside, direction by direction, without pictures.

    Ends with 1 where a value is off by more than 1e-4 of itself.
    """
    from reports.candidates import CandidateError, Command, outside_candidate
    from reports.doctor.brdf import examine_brdf
    from reports.doctor.told import print_answers
    from scenes.schema import NAMED_MODELS
    from scenes.suite import shelf_materials

    command = outside_candidate(candidate, timeout)
    if not isinstance(command, Command):
        problem, remedy = "is no command", "give one with {case} and {out}"
        raise InputError("--candidate", candidate, problem, remedy)
    if model not in NAMED_MODELS:
        raise InputError("--model", model, "no such model", f"use {' or '.join(NAMED_MODELS)}")
    shelf = {m.name: m for m in shelf_materials()}
    if unknown := [name for name in material or [] if name not in shelf]:
        remedy = f"use one of {', '.join(shelf)}"
        raise InputError("--material", unknown[0], "no such material", remedy)
    try:
        found = examine_brdf(command, NAMED_MODELS[model], [shelf[n] for n in material or []])
    except CandidateError as error:
        raise InputError("--candidate", command.words[0], str(error), "mend the program") from error
    print_answers(found, console)
    raise typer.Exit(0 if all(a.off.passed for a in found) else 1)
