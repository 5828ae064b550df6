"""The command `shadeproof`: options in, exit code out (0 good, 1 gate failed, 2 could not work)."""

import os
import shlex
import signal
import sys
import traceback
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Annotated, NoReturn

import typer
from rich.console import Console

from scenes.errors import InputError

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
)
refs = typer.Typer(no_args_is_help=True, help="Tell, pack, unpack and verify references.")
app.add_typer(refs, name="refs")
# A file or a pipe has no width of its own; 160 columns hold five weights.
console = Console(highlight=False, width=None if sys.stdout.isatty() else 160)

SuiteOption = Annotated[
    str, typer.Option("--suite", help="A suite's name, or the path of its .toml.")
]
OutOption = Annotated[Path, typer.Option("--out", help="Where results, frames and the report go.")]
StoreOption = Annotated[Path, typer.Option("--store", help="Where references are kept.")]
FilterOption = Annotated[
    str, typer.Option("--filter", help="Only cases whose name holds or matches this.")
]
CandidateOption = Annotated[
    str,
    typer.Option(help="Judge this instead: a folder of EXRs, or a command with {case} and {out}."),
]
TimeoutOption = Annotated[
    float, typer.Option(min=0.1, help="Seconds that a candidate command may take.")
]
FrozenOption = Annotated[
    bool,
    typer.Option("--frozen", help="Path-trace nothing; exit with 2 if a reference is missing."),
]
ClusterOption = Annotated[
    str | None,
    typer.Option(help="Path-trace on the workers of this Dask scheduler, tcp://host:port."),
]
OUT, STORE = Path("reports/out"), Path("reports/references")


def _say_version(asked: bool) -> None:
    if asked:
        typer.echo(metadata.version("shadeproof"))
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_say_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """How far is a real-time renderer from the truth, per material and mixture weight?"""


@app.command()
def compare(
    suite: SuiteOption = "default",
    out: OutOption = OUT,
    store: StoreOption = STORE,
    filter: FilterOption = "",
    candidate: CandidateOption = "",
    timeout: TimeoutOption = 600,
    frozen: FrozenOption = False,
    cluster: ClusterOption = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what would be done, do nothing.")
    ] = False,
    list_cases: Annotated[
        bool, typer.Option("--list", help="Print the names of the cases.")
    ] = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print the results as JSON, nothing else.")
    ] = False,
) -> None:
    """Draw a suite with both renderers and report how far apart they are."""
    job = _job(suite, out, store, filter, candidate, timeout, frozen, cluster)
    if list_cases:
        for entry in job.entries:
            typer.echo(entry.case.id)
        return
    if dry_run:
        _print_plan(job)
        return
    _compare(job, json)


@app.command()
def gate(
    suite: SuiteOption = "default",
    out: OutOption = OUT,
    store: StoreOption = STORE,
    filter: FilterOption = "",
    candidate: CandidateOption = "",
    timeout: TimeoutOption = 600,
    frozen: FrozenOption = False,
    cluster: ClusterOption = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print the results as JSON, nothing else.")
    ] = False,
) -> None:
    """Compare, and exit with 1 unless every row meets its budget.

    What meets its budget is measured no further than that takes.
    """
    from reports.gate import headline

    job = _job(suite, out, store, filter, candidate, timeout, frozen, cluster, brief=True)
    results = _compare(job, json)
    if headline(results) == "reported" and not json:
        console.print("[red bold]FAIL[/]: a gate needs a row with a budget")
    raise typer.Exit(0 if results.verdict == "pass" else 1)


@app.command()
def report(out: OutOption = OUT) -> None:
    """Write report.html again from the results in a folder."""
    from reports.results import load_results

    console.print(f"report: {_page(load_results(out / 'results.json'), out)}", soft_wrap=True)


@app.command()
def references(
    suite: SuiteOption = "default",
    store: StoreOption = STORE,
    filter: FilterOption = "",
    samples: Annotated[int, typer.Option(min=1, help="Samples per pixel to reach.")] = 256,
    frozen: FrozenOption = False,
    cluster: ClusterOption = None,
) -> None:
    """Path-trace the references of a suite ahead of time and keep them."""
    from reports.run.tracing import references as make

    job = _job(suite, OUT, store, filter, frozen=frozen, cluster=cluster)
    for case, truth, spp, seconds in make(job, samples):
        console.print(
            f"{case:40} {truth:12} {spp:6} samples per pixel {seconds:8.1f} s", soft_wrap=True
        )


@refs.command("list")
def list_references(store: StoreOption = STORE) -> None:
    """What a store holds, and whether this machine's code made it."""
    from reports.refs import print_list

    print_list(store, console)


@refs.command()
def pack(
    out: Annotated[Path, typer.Option("--out", help="The file to write.")],
    suite: SuiteOption = "default",
    filter: FilterOption = "",
    store: StoreOption = STORE,
) -> None:
    """Put a suite's references into one file, and print its SHA-256."""
    from reports.refs import pack_suite

    pack_suite(_job(suite, OUT, store, filter), out, console)


@refs.command()
def unpack(
    file: Annotated[Path, typer.Argument(help="A pack.")],
    digest: Annotated[str, typer.Option(help="The SHA-256 that it must have.")] = "",
    store: StoreOption = STORE,
) -> None:
    """Bless a pack's references: use them, whatever code or packages made them."""
    from reports.refs import unpack_file

    unpack_file(file, digest, store, console)


@refs.command()
def verify(
    suite: SuiteOption = "default",
    filter: FilterOption = "",
    store: StoreOption = STORE,
    batches: Annotated[
        int, typer.Option(min=0, help="Fresh batches for each; 0 checks the files alone.")
    ] = 8,
    cluster: ClusterOption = None,
) -> None:
    """Check every file, and path-trace anew to see that stored references still hold."""
    from reports.refs import verify_suite

    job = _job(suite, OUT, store, filter, cluster=cluster)
    raise typer.Exit(0 if verify_suite(job, batches, console) else 1)


@app.command()
def bench(
    suite: SuiteOption = "bench",
    filter: FilterOption = "",
    store: StoreOption = STORE,
) -> None:
    """Time every technique of a suite beside one path-traced sample per pixel."""
    from reports.run.measures import bench as measure
    from reports.speed import print_timings

    print_timings(measure(_job(suite, OUT, store, filter)), console)


@app.command()
def calibrate(
    store: StoreOption = STORE,
    filter: FilterOption = "",
    resamplings: Annotated[int, typer.Option(min=1, help="How often to draw 8 batches.")] = 100,
) -> None:
    """Measure whether the intervals hold, on a stored pool of batches; see docs/noise.md."""
    from reports.calibration import print_tables, resample
    from reports.progress import reporting
    from reports.run.tracing import pools as make

    records, pools = [], make(_job("calibration", OUT, store, filter))
    with reporting(resamplings * len(pools)) as progress:
        for pool in pools:
            records += resample(pool, resamplings, partial(progress.step, pool.name))
    print_tables(records, pools, console)


@app.command()
def efficiency(
    suite: SuiteOption = "default",
    filter: FilterOption = "",
    store: StoreOption = STORE,
) -> None:
    """Time the references to an interval, beside the plain path tracer."""
    from reports.efficiency import print_efficiencies
    from reports.run.measures import efficiency as measure

    print_efficiencies(measure(_job(suite, OUT, store, filter)), console)


@app.command()
def stability() -> None:
    """Hold the shaders' BRDF against double precision and Mitsuba, direction by direction."""
    from reports.run.measures import stability as measure

    found = measure()
    for a in found:
        mark = "[green]ok[/]  " if a.passed else "[red]off[/] "
        place = ", ".join(f"{x:.7g}" for x in (*a.wi, *a.wo))
        console.print(
            f"{mark} masking {a.masking} alpha {a.alpha:<5g} GGX share {a.weight:<5g} "
            f"beside {a.beside:16} worst {a.worst:.1e} at wi, wo = {place}",
            soft_wrap=True,
        )
    raise typer.Exit(0 if all(a.passed for a in found) else 1)


@app.command()
def furnace() -> None:
    """Test the paper's claim that its mixture keeps energy, with both maskings."""
    from reports.furnace import energy_claim
    from reports.terminal import print_energy_claim

    print_energy_claim(energy_claim(), console)


def _job(
    suite: str,
    out: Path,
    store: Path,
    filter: str,
    candidate: str = "",
    timeout: float = 600,
    frozen: bool = False,
    cluster: str | None = None,
    brief: bool = False,
):
    from reports.candidates import outside_candidate
    from reports.run.job import Job

    outside = outside_candidate(candidate, timeout) if candidate else None
    command = shlex.join(["shadeproof", *sys.argv[1:]])
    return Job(suite, out, store, filter, outside, command, frozen, cluster, brief)


def _page(results, out: Path) -> Path:
    """Write the report, which takes some seconds."""
    from reports.html import write_report
    from reports.progress import reporting

    with reporting(1) as progress:
        progress.step("report")
        return write_report(results, out)


def _compare(job, json: bool):
    """Run a job, write everything that it gives, and say the verdict."""
    from reports.ci import annotate, write_junit
    from reports.results import save_results
    from reports.run.suite import run
    from reports.terminal import print_results

    results = run(job)
    page = _page(results, job.out)
    write_junit(results, job.out / "junit.xml")
    annotate(results, job.out / "summary.md")
    save_results(results, job.out / "results.json")
    if json:
        typer.echo(results.model_dump_json(indent=1))
    else:
        print_results(results, console)
        console.print(f"report: {page.resolve()}", soft_wrap=True)
    return results


def _print_plan(job) -> None:
    from reports.run.tracing import plan

    for line in plan(job):
        typer.echo(line)


def main() -> None:
    """Entry point: every failure that is not a verdict ends in one line and exit code 2."""
    asked = False

    def stop(*_: object) -> None:
        nonlocal asked
        asked = True
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, stop)
    signal.signal(signal.SIGTERM, stop)  # CI's cancel ends like Ctrl-C
    try:
        app()
    except InputError as error:
        _fail(str(error))
    except OSError as error:
        _fail(f"{error.filename or 'output'}: {error.strerror}")
    except Exception as error:
        if asked:  # an interrupted import fails as it likes
            _interrupted()
        traceback.print_exc()
        _fail(f"this is a bug in shadeproof: {type(error).__name__}: {error}")
    except (SystemExit, KeyboardInterrupt):
        if asked:
            _interrupted()
        raise


def _fail(text: str) -> NoReturn:
    Console(stderr=True, highlight=False).print(f"error: {text}", markup=False, soft_wrap=True)
    sys.exit(2)


def _interrupted() -> NoReturn:
    print("interrupted; finished batches are kept, run again to go on", file=sys.stderr, flush=True)
    os._exit(130)  # the libraries' own exit hooks would talk over this


if __name__ == "__main__":
    main()
