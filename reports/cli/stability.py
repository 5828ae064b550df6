"""The command that holds the shaders against double precision and Mitsuba."""

import shlex
import sys
from typing import Annotated

import typer

from reports.cli.app import app, console, when_interrupted
from reports.cli.options import OUT, OutOption
from scenes.errors import InputError


@app.command()
def stability(
    out: OutOption = OUT,
    at: Annotated[
        list[str] | None,
        typer.Option(help="Only evaluate this: a function and its inputs, as the page tells them."),
    ] = None,
    hard: Annotated[
        list[str] | None, typer.Option(help="Only try this hard case, by name.")
    ] = None,
    list_names: Annotated[
        bool, typer.Option("--list", help="Print the functions for --at and the names for --hard.")
    ] = False,
) -> None:
    """Hold the shaders against double precision and Mitsuba, over every hard input.

    Ends with 1 where a figure is over its limit, with --at and --hard too.
    """
    from reports.html.stability import write_page
    from reports.run.job import make_folder
    from reports.run.stability import hard_cases
    from reports.run.stability import stability as measure
    from reports.stability.results import save_stability
    from reports.stability.table import print_hard, print_stability

    if at and hard:
        raise InputError("--at", "", "stands beside --hard", "give one of the two")
    if list_names:
        _list()
        return
    when_interrupted.append("nothing is kept")
    if at:
        raise typer.Exit(0 if _evaluated(at) else 1)
    if hard:
        cases = hard_cases(hard)
        print_hard(cases, console)
        raise typer.Exit(0 if all(case.passed for case in cases) else 1)
    make_folder(out, "--out")
    found = measure(shlex.join(["shadeproof", *sys.argv[1:]]))
    save_stability(found, out / "stability.json")
    print_stability(found, console)
    console.print(f"page: {write_page(found, out).resolve()}", soft_wrap=True)
    raise typer.Exit(0 if found.passed else 1)


def _list() -> None:
    from reports.run.stability import hard_names
    from reports.stability.functions import FUNCTIONS
    from reports.stability.points import INTEGRALS, taken

    for name in (*FUNCTIONS, *INTEGRALS):
        typer.echo(f"--at '{' '.join([name, *(f'{i}=...' for i in taken(name))])}'")
    for name in hard_names():
        typer.echo(f"--hard {name}")


def _evaluated(texts: list[str]) -> bool:
    """Print what becomes of points, and of a step between two; whether all pass."""
    from reports.run.stability.at import evaluate, step
    from reports.stability.points import point
    from reports.stability.table import print_points

    points = [point(text) for text in texts]  # all are read before any is evaluated
    answers = [evaluate(p) for p in points]
    if len(points) == 2 and (between := step(*points)):
        texts, answers = [*texts, "from the first to the second"], [*answers, between]
    print_points(texts, answers, console)
    return all(a.passed for a in answers)
