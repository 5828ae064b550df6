"""Commands about references: trace them ahead, tell, pack, unpack and verify them."""

from pathlib import Path
from typing import Annotated

import typer

from reports.cli.app import app, console
from reports.cli.options import STORE, StoreOption, takes_job

refs = typer.Typer(no_args_is_help=True, help="Tell, pack, unpack and verify references.")
app.add_typer(refs, name="refs")


@app.command()
@takes_job("suite", "store", "filter", "frozen", "cluster")
def references(
    job,
    samples: Annotated[int, typer.Option(min=1, help="Samples per pixel to reach.")] = 256,
) -> None:
    """Path-trace the references of a suite ahead of time and keep them."""
    from reports.run.tracing import references as make

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
@takes_job("suite", "store", "filter")
def pack(job, out: Annotated[Path, typer.Option("--out", help="The file to write.")]) -> None:
    """Put a suite's references into one file, and print its SHA-256."""
    from reports.refs import pack_suite

    pack_suite(job, out, console)


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
@takes_job("suite", "store", "filter", "cluster")
def verify(
    job,
    batches: Annotated[
        int, typer.Option(min=0, help="Fresh batches for each; 0 checks the files alone.")
    ] = 8,
) -> None:
    """Check every file, and path-trace anew to see that stored references still hold."""
    from reports.refs import verify_suite

    raise typer.Exit(0 if verify_suite(job, batches, console) else 1)
