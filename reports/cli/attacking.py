"""The command that attacks the gate."""

import fnmatch
import shlex
import sys
import tempfile
from pathlib import Path
from typing import Annotated, Literal

import typer

from reports.cli.app import app, console
from reports.cli.options import OUT, OutOption
from scenes.errors import InputError

COUNT, SEED = 60, 5


@app.command()
def attack(
    suite: Annotated[
        str, typer.Option(help="A suite whose references come with the code, or are in --store.")
    ] = "guard",
    out: OutOption = OUT,
    store: Annotated[
        Path | None, typer.Option(help="References; without it, those that come with the code.")
    ] = None,
    count: Annotated[int, typer.Option(min=0, help="How many mutants by rule.")] = COUNT,
    everything: Annotated[bool, typer.Option("--all", help="Every mutant by rule: hours.")] = False,
    seed: Annotated[int, typer.Option(help="Of the choice among mutants by rule.")] = SEED,
    only: Annotated[
        str, typer.Option(help="Only changes whose name matches this, of all there are.")
    ] = "",
    kind: Annotated[
        Literal["realistic", "rule", "control"] | None, typer.Option(help="Only changes of a kind.")
    ] = None,
    jobs: Annotated[int, typer.Option(min=1, max=16, help="Gates at a time.")] = 2,
) -> None:
    """Inject shader bugs into copies of the renderer: does the gate see them?

    Ends with 1 where it misses one that could be seen, or fails on a harmless rewrite.
    """
    from reports.attack.mutants import select
    from reports.attack.results import save_attack
    from reports.attack.table import print_attack
    from reports.html.attack import write_page
    from reports.progress import reporting
    from reports.run.attack import attack_suite, shipped
    from reports.run.job import make_folder

    injected, generated = select(sys.maxsize if everything or only else count, seed)
    if only:
        injected = [i for i in injected if only in i.id or fnmatch.fnmatchcase(i.id, only)]
    injected = [i for i in injected if kind in (None, i.kind)]
    if not injected:
        raise InputError("--only", only, "no change has such a name", "see attack.json for names")
    make_folder(out, "--out")
    command = shlex.join(["shadeproof", *sys.argv[1:]])
    with tempfile.TemporaryDirectory() as folder, reporting(len(injected)) as progress:
        found = attack_suite(
            suite,
            store or shipped(suite, Path(folder)),
            injected,
            jobs,
            progress.step,
            command=command,
            seed=seed,
            generated=generated,
        )
    save_attack(found, out / "attack.json")
    print_attack(found, console)
    console.print(f"page: {write_page(out).resolve()}", soft_wrap=True)
    raise typer.Exit(0 if found.passed else 1)
