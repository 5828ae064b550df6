"""The options that commands share, and the job that they describe."""

import inspect
import shlex
import sys
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Annotated, Any

import typer

MOST_SEED = 999_999  # short enough for the names of files
MOST_CASES = 200  # more would be a slip: each takes minutes

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
DrawOption = Annotated[
    int | None,
    typer.Option(
        "--draw",
        min=0,
        max=MOST_SEED,
        metavar="SEED",
        help="Cases drawn at random from this seed, instead of the suite's own.",
    ),
]
CountOption = Annotated[
    int | None, typer.Option(min=1, max=MOST_CASES, help="How many to --draw; 8 if not given.")
]
TruthOption = Annotated[
    Path | None,
    typer.Option(help="Your own references: a folder with <case>/*.exr, a batch each."),
]
OursOption = Annotated[
    bool, typer.Option("--ours", help="Beside a --candidate draw the suite's techniques, too.")
]
VerdictOption = Annotated[
    bool,
    typer.Option("--verdict-only", help="No report, no times, and no figures but those judged."),
]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Print the results as JSON, nothing else.")
]
OUT, STORE = Path("reports/out"), Path("reports/references")
EVERY = ("suite", "draw", "count", "out", "store", "filter", "candidate", "timeout")
EVERY += ("frozen", "cluster", "truth", "ours")


def make_job(
    suite: SuiteOption = "default",
    draw: DrawOption = None,
    count: CountOption = None,
    out: OutOption = OUT,
    store: StoreOption = STORE,
    filter: FilterOption = "",
    candidate: CandidateOption = "",
    timeout: TimeoutOption = 600,
    frozen: FrozenOption = False,
    cluster: ClusterOption = None,
    truth: TruthOption = None,
    ours: OursOption = False,
    verdict_only: VerdictOption = False,
    brief: bool = False,
):
    """The job that options describe.

    Raises:
        InputError: they describe none.
    """
    from reports.candidates import outside_candidate
    from reports.run.job import Job
    from scenes.errors import InputError

    if count and draw is None:
        raise InputError("--count", str(count), "counts drawn cases", "add --draw SEED")
    if ours and not candidate:
        raise InputError("--ours", "", "there is no candidate beside ours", "add --candidate")
    outside = outside_candidate(candidate, timeout) if candidate else None
    if draw is not None:
        suite = _drawn(suite, draw, count, out)
    command = shlex.join(["shadeproof", *sys.argv[1:]])
    if truth is not None and not truth.is_dir():
        problem = "is a file, no folder" if truth.is_file() else "no such folder"
        raise InputError("--truth", str(truth), problem, "give a folder with <case>/*.exr")
    return Job(
        suite,
        out,
        store,
        filter=filter,
        outside=outside,
        command=command,
        frozen=frozen,
        cluster=cluster,
        brief=brief,
        verdict_only=verdict_only,
        truth=truth,
        ours=ours,
    )


def _drawn(suite: str, seed: int, count: int | None, out: Path) -> str:
    """Draw cases that are asked what a suite asks; the path of their own."""
    from reports.run.job import make_folder
    from scenes.draw.suite import COUNT, draw_suite
    from scenes.suite import load_suite

    base, path = load_suite(suite)
    make_folder(out, "--out")
    return str(draw_suite(base, path.stem, seed, count or COUNT, out / "drawn" / str(seed)))


def takes_job(*names: str, **values: Any) -> Callable[[Callable], Callable]:
    """Make a command of a function whose first parameter is the job that options describe.

    Args:
        names: the parameters of `make_job` that the command has as options.
        values: other values for its parameters; of an option, its default.
    """

    def wrap(command: Callable) -> Callable:
        known = inspect.signature(make_job).parameters
        shown = [known[n].replace(default=values.get(n, known[n].default)) for n in names]
        _, *own = inspect.signature(command).parameters.values()

        @wraps(command)
        def call(**given: Any) -> Any:
            job = make_job(**values | {name: given.pop(name) for name in names})
            return command(job, **given)

        # By keyword, so that an option without a default may follow one that has it.
        options = [p.replace(kind=p.KEYWORD_ONLY) for p in (*shown, *own)]
        call.__signature__ = inspect.Signature(options)
        call.__annotations__ = {p.name: p.annotation for p in options}
        return call

    return wrap
