"""The command that measures what the gate can see, and how often it cries wolf."""

from typing import Annotated

import typer

from reports.cli.app import app, console
from reports.cli.options import takes_job


@app.command()
@takes_job("suite", "out", "store", "filter", suite="guard")
def limits(
    job,
    sets: Annotated[
        int, typer.Option(min=20, help="Sets of batches for each size of each error.")
    ] = 100,
    alarms: Annotated[
        int, typer.Option(min=1, help="Sets of batches for each picture that is right.")
    ] = 300,
    pool: Annotated[
        int, typer.Option(min=16, help="Batches of each reference that sets are drawn from.")
    ] = 32,
) -> None:
    """Measure the smallest errors that the gate catches 95 times in 100, and its false alarms.

    Ends with 1 where it fails a picture that is right.
    """
    from reports.html.attack import write_page
    from reports.limits.results import save_limits
    from reports.limits.table import print_limits
    from reports.run.limits import limits as measure

    found = measure(job, sets, alarms, pool)
    save_limits(found, job.out / "limits.json")
    print_limits(found, console)
    console.print(f"page: {write_page(job.out).resolve()}", soft_wrap=True)
    raise typer.Exit(1 if any(f.alarms for f in found.false_alarms) else 0)
