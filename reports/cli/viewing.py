"""The command that opens a live window on a suite."""

from reports.cli.app import app, console
from reports.cli.options import takes_job
from scenes.errors import InputError


@app.command()
@takes_job("suite", "filter", "store")
def view(job) -> None:
    """Look around in a suite's cases, live: orbit, change what is drawn, toggle the reference."""
    from reports.run.window.show import KEYS, OTHERS, show
    from reports.run.window.state import State

    for key, _, told in KEYS:
        console.print(f"{key:12} {told}; with Shift the one before", markup=False)
    for key, told in OTHERS:
        console.print(f"{key:12} {told}", markup=False)
    try:
        show(State.of(job))
    except Exception as error:
        if "display" not in f"{type(error).__name__} {error}".lower():
            raise
        remedy = "run it in a desktop session, or under xvfb-run"
        raise InputError("view", "DISPLAY", "there is no display to open it on", remedy) from error
