"""Commands that measure the instruments: speed, intervals, shaders and the paper's claim."""

from enum import StrEnum
from functools import partial
from typing import Annotated

import typer

from reports.cli.app import app, console
from reports.cli.options import takes_job

MOST_FRAMES = 1000  # more would be a slip: quartiles are settled long before


class Extra(StrEnum):
    """What a bench measures besides the points of its cases."""

    needs = "needs"
    lobes = "lobes"
    growth = "growth"


@app.command()
@takes_job("suite", "draw", "count", "out", "store", "filter", suite="bench")
def bench(
    job,
    frames: Annotated[
        int, typer.Option(min=3, max=MOST_FRAMES, help="Warm frames of each way to draw.")
    ] = 9,
    skip: Annotated[
        list[Extra] | None,
        typer.Option(help="Leave this unmeasured; for two, --skip growth --skip lobes."),
    ] = None,
) -> None:
    """Measure time and error of every technique beside path tracing, raw and denoised."""
    from reports.html.speed import write_page
    from reports.run.bench import bench as measure
    from reports.speed.points import save_bench
    from reports.speed.table import print_bench

    found = measure(job, frames, skip or ())
    save_bench(found, job.out / "bench.json")
    print_bench(found, console)
    console.print(f"page: {write_page(found, job.out).resolve()}", soft_wrap=True)


@app.command()
@takes_job("store", "filter", suite="calibration")
def calibrate(
    job,
    resamplings: Annotated[int, typer.Option(min=1, help="How often to draw 8 batches.")] = 100,
) -> None:
    """Measure whether the intervals hold, on a stored pool of batches; see docs/noise.md."""
    from reports.calibration import print_tables, resample
    from reports.progress import reporting
    from reports.run.tracing import pools as make

    records, pools = [], make(job)
    with reporting(resamplings * len(pools)) as progress:
        for pool in pools:
            records += resample(pool, resamplings, partial(progress.step, pool.name))
    print_tables(records, pools, console)


@app.command()
@takes_job("suite", "store", "filter")
def efficiency(job) -> None:
    """Time the references to an interval, beside the plain path tracer."""
    from reports.efficiency import print_efficiencies
    from reports.run.measures import efficiency as measure

    print_efficiencies(measure(job), console)


@app.command()
def furnace() -> None:
    """Test the paper's claim that its mixture keeps energy, with both maskings."""
    from reports.furnace import energy_claim
    from reports.terminal import print_energy_claim

    print_energy_claim(energy_claim(), console)
