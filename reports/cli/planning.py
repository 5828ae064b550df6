"""The command that picks techniques by what a bench measured."""

import shlex
import sys
from pathlib import Path
from typing import Annotated, Literal

import typer

from reports.cli.app import app, console
from reports.cli.options import OUT
from scenes.errors import InputError


@app.command()
def plan(
    max_error: Annotated[
        float | None, typer.Option(help="The largest error that will do, for every object.")
    ] = None,
    max_ms: Annotated[
        float | None, typer.Option(help="The longest warm frame that will do, in milliseconds.")
    ] = None,
    figure: Annotated[
        Literal["energy_local", "ssim"], typer.Option(help="The error; for ssim it is 1 - SSIM.")
    ] = "energy_local",
    bench: Annotated[Path, typer.Option(help="What was measured.")] = OUT / "bench.json",
    environment: Annotated[
        list[str] | None, typer.Option(help="Plan for this environment too; may be repeated.")
    ] = None,
    to: Annotated[
        Path | None, typer.Option(help="The suite to write, a .toml; without it, it is printed.")
    ] = None,
) -> None:
    """Pick per case the cheapest technique within an error, or the best within a time.

    Ends with 1, and writes nothing, where no technique is good enough.
    """
    from reports.speed.plan import OutOfReachError, chosen, planned, text
    from reports.speed.points import load_bench
    from scenes.frame import write_text
    from scenes.suite import load_suite

    goal = _goal(figure, max_error, max_ms)
    if to and to.suffix != ".toml":
        raise InputError("--to", str(to), "is no .toml", "name a file that ends in .toml")
    measured = load_bench(bench)
    if not Path(measured.suite_path).is_file():
        problem = f"names a suite that is gone: {measured.suite_path}"
        raise InputError(bench, "suite_path", problem, "run `shadeproof bench` anew")
    suite, path = load_suite(measured.suite_path)
    if to and to.resolve() == path:
        raise InputError("--to", str(to), "is the suite that was measured", "name another file")
    lights = [_found(light) for light in environment or []]
    try:
        picked = chosen(measured, goal)
    except OutOfReachError as reason:
        console.print(f"plan: {reason}", soft_wrap=True, markup=False)
        raise typer.Exit(1) from reason
    if not picked:
        problem = "holds no technique of a real-time renderer"
        raise InputError(bench, "points", problem, "run `shadeproof bench` with one")
    command = shlex.join(["shadeproof", *sys.argv[1:]])
    written = text(planned(suite, path, picked, goal, lights), picked, goal, command)
    if not to:
        typer.echo(written, nl=False)
        return
    write_text(to, written)
    for case, point in picked.items():
        console.print(f"{case}: {goal.told(point)}", soft_wrap=True, markup=False)
    # A time is no budget, and a gate needs one.
    how = "compare" if goal.max_error is None else "gate"
    console.print(f"plan: {to}; `shadeproof {how} --suite {shlex.quote(str(to))}` checks it")


def _goal(figure, max_error: float | None, max_ms: float | None):
    """What the options ask for; one of them, and more than nothing."""
    from reports.speed.plan import Goal

    given = {"--max-error": max_error, "--max-ms": max_ms}
    named = {option: value for option, value in given.items() if value is not None}
    if len(named) != 1:
        problem = "both are given" if named else "neither is given"
        raise InputError("--max-error, --max-ms", "", problem, "give one of them")
    ((option, value),) = named.items()
    if not 0 < value < float("inf"):
        raise InputError(option, f"{value:g}", "is no budget", "give a number greater than 0")
    if figure == "ssim" and max_error is not None and max_error >= 1:
        raise InputError(option, f"{value:g}", "1 - SSIM is at most 1", "give less than 1")
    return Goal(figure, max_error, None if max_ms is None else max_ms / 1e3)


def _found(environment: str) -> str:
    """An environment that can be read, by its name on our shelf or a file's absolute path."""
    from scenes.environment import FORMATS, load_environment
    from scenes.files import find
    from scenes.suite import HERE

    shelf = HERE / "environments"
    path = find(environment, shelf, FORMATS, Path.cwd(), "--environment", "")
    load_environment(path)
    return str(path) if Path(environment).suffix.lower() in FORMATS else environment
