"""The command that attacks the gate."""

import fnmatch
import shlex
import sys
import tempfile
from pathlib import Path
from typing import Annotated, Literal

import typer

from reports.cli.app import app, console, when_interrupted
from reports.cli.options import OUT
from scenes.errors import InputError
from scenes.words import nearest

COUNT, SEED = 60, 5


@app.command()
def attack(
    suite: Annotated[
        str, typer.Option(help="A suite whose references come with the code, or are in --store.")
    ] = "guard",
    out: Annotated[
        Path | None,
        typer.Option(
            help=f"Where attack.json and its page go, {OUT} by default; with --only or --kind "
            "nothing is written without it.",
        ),
    ] = None,
    store: Annotated[
        Path | None, typer.Option(help="References; without it, those that come with the code.")
    ] = None,
    count: Annotated[int, typer.Option(min=0, help="How many mutants by rule.")] = COUNT,
    everything: Annotated[bool, typer.Option("--all", help="Every mutant by rule: hours.")] = False,
    seed: Annotated[int, typer.Option(help="Of the choice among mutants by rule.")] = SEED,
    only: Annotated[
        str, typer.Option(help="Only changes whose name holds or matches this, of all there are.")
    ] = "",
    kind: Annotated[
        Literal["realistic", "rule", "control"] | None, typer.Option(help="Only changes of a kind.")
    ] = None,
    jobs: Annotated[int, typer.Option(min=1, max=16, help="Gates at a time.")] = 2,
    list_names: Annotated[
        bool, typer.Option("--list", help="Print the names of all changes, or of those asked for.")
    ] = False,
) -> None:
    """Inject shader bugs into copies of the renderer: does the gate see them?

    Ends with 1 where it misses one that could be seen, or fails on a harmless rewrite.
    """
    from reports.attack.mutants import select
    from reports.attack.table import print_attack, told
    from reports.progress import reporting
    from reports.run.attack import attack_suite, kept_in, shipped
    from reports.run.job import make_folder

    changes, generated = select(sys.maxsize if everything or only or list_names else count, seed)
    changes = _asked_for(changes, only, kind)
    if list_names:
        for change in changes:
            typer.echo(change.id)
        return
    when_interrupted.append("nothing is kept")
    if out is None and not (only or kind):
        out = OUT
    with tempfile.TemporaryDirectory() as folder, reporting(len(changes)) as progress:
        references = store or shipped(suite, Path(folder))
        kept = None
        if out:
            make_folder(out, "--out")
            kept = kept_in(out, suite, store)
            when_interrupted.append("verdicts are kept, run again to go on")
        found = attack_suite(
            suite,
            references,
            changes,
            jobs,
            lambda mutant: progress.step(told(mutant)),
            kept,
            command=shlex.join(["shadeproof", *sys.argv[1:]]),
            seed=seed,
            generated=generated,
        )
    print_attack(found, console)
    if out:
        _write(found, out)
        kept.remove()
    raise typer.Exit(0 if found.passed else 1)


def _asked_for(changes: list, only: str, kind: str | None) -> list:
    """Those of a name and a kind; at least one."""
    named = [c for c in changes if only in c.id or fnmatch.fnmatchcase(c.id, only)]
    if not named and only:
        remedy = nearest(only, [c.id for c in changes]) + "see `shadeproof attack --list`"
        raise InputError("--only", only, "no change has such a name", remedy)
    chosen = [c for c in named if kind in (None, c.kind)]
    if not chosen and only:
        remedy = f"leave out --kind, or give --kind {named[0].kind}"
        raise InputError("--kind", str(kind), f"no change named '{only}' is of it", remedy)
    if not chosen:
        raise InputError("--count", "0", "leaves nothing to try", "give 1 or more")
    return chosen


def _write(found, out: Path) -> None:
    from reports.attack.results import save_attack
    from reports.html.attack import write_page

    save_attack(found, out / "attack.json")
    console.print(f"page: {write_page(out).resolve()}", soft_wrap=True)
