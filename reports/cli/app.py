"""What every command hangs on: the application and where it prints."""

import sys
from importlib import metadata
from typing import Annotated

import typer
from rich.console import Console

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
)
# A file or a pipe has no width of its own; 160 columns hold five weights.
console = Console(highlight=False, width=None if sys.stdout.isatty() else 160)

# What is told of a command that is interrupted; one that keeps other things says so itself.
when_interrupted = ["finished batches are kept, run again to go on"]


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
