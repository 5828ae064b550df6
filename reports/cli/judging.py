"""Commands that hold candidates against the truth, and show what they found."""

from pathlib import Path
from typing import Annotated

import typer

from reports.cli.app import app, console
from reports.cli.options import EVERY, OUT, JsonOption, OutOption, takes_job


@app.command()
@takes_job(*EVERY)
def compare(
    job,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what would be done, do nothing.")
    ] = False,
    list_cases: Annotated[
        bool, typer.Option("--list", help="Print the names of the cases.")
    ] = False,
    beside: Annotated[
        Path | None,
        typer.Option(help="Another run's results.json: tell how far off this one is beside it."),
    ] = None,
    against: Annotated[
        Path | None,
        typer.Option(help="An earlier run's results.json: tell what changed since, row by row."),
    ] = None,
    json: JsonOption = False,
) -> None:
    """Draw a suite with both renderers and report how far apart they are."""
    from reports.run.tracing import plan

    if list_cases or dry_run:
        for line in [e.case.id for e in job.entries] if list_cases else plan(job):
            typer.echo(line)
        return
    _compare(job, json, beside, against)


@app.command()
@takes_job(*EVERY, "verdict_only", brief=True)
def gate(
    job,
    absolute: Annotated[
        bool,
        typer.Option("--absolute", help="Judge by the suite's budgets, with --regression too."),
    ] = False,
    regression: Annotated[
        Path | None,
        typer.Option(help="An earlier run's results.json: fail where a row is worse than there."),
    ] = None,
    json: JsonOption = False,
) -> None:
    """Compare, and exit with 1 unless every row meets its budget, or is no worse than before.

    What meets its budget is measured no further than that takes.
    """
    from reports.gate import headline

    if regression and not absolute:
        job = job.without_budgets()
    results = _compare(job, json, against=regression, judged=True)
    if headline(results) == "reported" and not json:
        console.print("[red bold]FAIL[/]: a gate needs a row with a budget; add one to the suite")
    raise typer.Exit(0 if results.verdict == "pass" else 1)


@app.command()
def report(out: OutOption = OUT) -> None:
    """Write report.html again from the results in a folder."""
    from reports.results import load_results

    console.print(f"report: {_page(load_results(out / 'results.json'), out)}", soft_wrap=True)


def _compare(
    job, json: bool, other: Path | None = None, against: Path | None = None, judged: bool = False
):
    """Run a job, write everything that it gives, and say the verdict.

    Args:
        other: results to tell ratios to.
        against: results to tell changes from; `judged` says whether worse rows fail the run.
    """
    from reports.beside import beside, load_other
    from reports.change.since import load_earlier, since
    from reports.ci import annotate, write_junit
    from reports.crops import write_crops
    from reports.history import load_history, remember
    from reports.results import save_results
    from reports.run.suite import run
    from reports.terminal import print_crops, print_results

    # Read first: it may be what this run writes over.
    shipped = load_other(other, job.expected(job.entries)) if other else None
    earlier = load_earlier(against, job.out) if against else None
    load_history(job.out)  # a damaged one is told before any work is done
    results = run(job)
    if earlier:
        results = since(results, job.out, earlier, against, judged)
    if shipped:
        results = beside(results, shipped, other)
    remember(results, job.out)
    page = None if job.verdict_only else _page(results, job.out)
    crops = write_crops(results, job.out)
    write_junit(results, job.out / "junit.xml")
    annotate(results, job.out / "summary.md", crops)
    save_results(results, job.out / "results.json")
    if json:
        typer.echo(results.model_dump_json(indent=1))
    else:
        print_results(results, console)
        print_crops(crops, job.out, results, console)
        if page:
            console.print(f"report: {page.resolve()}", soft_wrap=True)
    return results


def _page(results, out: Path) -> Path:
    """Write the report, which takes some seconds."""
    from reports.html import write_report
    from reports.progress import reporting

    with reporting(1) as progress:
        progress.step("report")
        return write_report(results, out)
