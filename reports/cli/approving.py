"""The command that takes new budgets from what was measured."""

from pathlib import Path
from typing import Annotated

import typer

from reports.cli.app import app, console
from reports.cli.options import OUT
from scenes.errors import InputError


@app.command()
def approve(
    results: Annotated[Path, typer.Argument(help="What was measured.")] = OUT / "results.json",
    reason: Annotated[
        str, typer.Option(help="Why budgets may be looser; without it they only get tighter.")
    ] = "",
    spare: Annotated[
        float,
        typer.Option(min=0, max=10, help="Share of each figure that later runs may be worse by."),
    ] = 0.1,
    write: Annotated[bool, typer.Option("--write", help="Change the suite's file.")] = False,
) -> None:
    """Propose budgets from what was measured, and show what would change in the suite.

    A budget becomes the worst of its rows with its noise and something to spare.
    """
    from reports.approve import check, difference, proposals, rewritten
    from reports.results import load_results
    from scenes.files import read_text
    from scenes.frame import write_text
    from scenes.suite import load_suite

    found = load_results(results)
    if not Path(found.suite_path).is_file():
        problem = f"names a suite that is gone: {found.suite_path}"
        raise InputError(results, "suite_path", problem, "run the suite again")
    suite, path = load_suite(found.suite_path)
    check(found, suite.budget, results)
    reason = reason.strip()
    proposed = proposals(found, suite.budget, spare)
    chosen = [p for p in proposed if reason or not p.looser]
    for p in proposed:
        if p.looser and not reason:
            console.print(
                f"looser, so it takes a --reason: budget.{p.rule} {p.metric} {p.old:g} to "
                f"{p.new:g}, for {p.row.object} in {p.row.case} ({p.row.technique} against "
                f"{p.row.truth})",
                soft_wrap=True,
                markup=False,
            )
    before = read_text(path, "give the results of a suite that is still there")
    after = rewritten(before, chosen, reason)
    typer.echo(difference(before, after, path.name), nl=False)
    if write and chosen:
        write_text(path, after)
    done = "written to" if write else "proposed for"
    console.print(f"approve: {len(chosen)} budgets {done} {path}", soft_wrap=True, markup=False)
