"""Speed against error: every technique beside path tracing, raw and denoised, in one run."""

import datetime
import os
import platform
import time
from collections.abc import Collection
from importlib import metadata
from typing import Any

from reference.batches import grow, truth_of
from reference.store import Store
from renderer.context import device
from reports.compare import Truth, exposures_of
from reports.progress import Reporter, reporting
from reports.run.bench import kernels
from reports.run.bench.equal import equal_errors
from reports.run.bench.growth import STEPS as GROWTH_STEPS
from reports.run.bench.growth import grown
from reports.run.bench.measured import Measured, lacking, measure
from reports.run.bench.needs import left_out
from reports.run.bench.realtime import NO_CACHES, RealTime
from reports.run.bench.way import Way
from reports.run.job import Job, make_folder
from reports.speed.lobes import lobe_sampling
from reports.speed.points import Bench, EqualError, LeftOut, Point
from scenes.schema import Case
from scenes.suite import HERE, Entry

ROUNDS = 9
PACKAGES = ("mitsuba", "drjit", "mitsuba-oidn", "moderngl", "numpy")
STEPS = 4  # of a case, that are told
LIGHT = HERE / "environments" / "courtyard.exr"  # under which a lobe's sampling is measured too


@kernels.kept_apart()
def bench(job: Job, rounds: int = ROUNDS, skip: Collection[str] = ()) -> Bench:
    """Measure every case of a job: points, and what path tracing needs to be as good.

    Nothing is written but the references that are lacking, and the folder for the results.

    Args:
        rounds: warm frames of each way.
        skip: what to leave unmeasured: `needs`, what each case does without; `lobes`, the
            sampling of a mixture; `growth`, how costs grow.

    Raises:
        InputError: an input cannot be used, a folder cannot be written, or there is no LLVM.
    """
    start = time.perf_counter()
    make_folder(job.out, "--out")
    make_folder(job.store, "--store")
    os.environ.update(NO_CACHES)
    from reports.run.bench.denoised import unavailable

    no_denoiser = unavailable()
    skipped = [*job.skipped, *([no_denoiser] if no_denoiser else [])]
    if not device().hardware:
        skipped.append(f"GPU times: {device().name} is no GPU")
    points: list[Point] = []
    equal: list[EqualError] = []
    without: list[LeftOut] = []
    steps = STEPS + ("needs" not in skip)
    extra = ("lobes" not in skip) + GROWTH_STEPS * ("growth" not in skip)
    with reporting(steps * len(job.entries) + extra) as report:
        for entry in job.entries:
            measured = _measured(job, entry, rounds, not no_denoiser, report)
            report.step(f"{entry.case.id}: first starts, changes and memory")
            for m in measured:
                report.detail(f"{entry.case.id}: {m.way.name}")
                gpu = m.way.gpu_frames(rounds)
                points.append(m.point(entry.case, gpu))
                m.way.close()
            skipped += lacking(entry.case, measured)
            equal += equal_errors(entry.case, measured)
            if "needs" not in skip:
                report.step(f"{entry.case.id}: what it does without")
                without += left_out(entry.case, entry.techniques)
        lobes = []
        if "lobes" not in skip:
            report.step("directions that a mixture takes")
            lobes = lobe_sampling((LIGHT,))
        growths = [] if "growth" in skip else grown(report)
    skipped += [f"{name}: --skip {name}" for name in skip]
    return Bench(
        suite=job.path.stem,
        suite_path=str(job.path),
        command=job.command,
        created=datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        seconds=time.perf_counter() - start,
        provenance=_provenance(),
        points=points,
        equal=equal,
        growths=growths,
        left_out=without,
        lobes=lobes,
        skipped=skipped,
    )


def _measured(
    job: Job, entry: Entry, rounds: int, denoise: bool, report: Reporter
) -> list[Measured]:
    """All ways to draw one case, timed and judged."""
    case = entry.case
    report.step(f"{case.id}: the truth")
    truth = _truth(job, case)
    report.step(f"{case.id}: start path tracing")
    ways = [RealTime(case, name) for name in entry.techniques]
    ways += _path_tracers(case, denoise)
    report.step(f"{case.id}: {len(ways)} ways, {rounds} rounds")
    return measure(case, ways, truth, rounds, lambda text: report.detail(f"{case.id}: {text}"))


def _truth(job: Job, case: Case) -> Truth:
    """`global` from the store, at least 8 batches."""
    store = Store(job.store)
    batches = grow(case, "model", job.suite.reference, lambda _: True, store)
    shown = [truth_of(batch, "global") for batch in batches]
    return Truth(case, "global", shown, exposures_of(case, shown))


def _path_tracers(case: Case, denoise: bool) -> list[Way]:
    """Mitsuba at every number of samples, and with the denoiser after it."""
    from reports.run.bench.denoised import Denoised, DenoisedTracer
    from reports.run.bench.path_traced import PathTraced, Tracer, samples_for, started

    counts = samples_for(case)
    raw = started(Tracer, case)
    ways: list[Way] = [PathTraced(raw, k) for k in counts]
    if denoise:
        guided = started(DenoisedTracer, case, raw.further)
        # Every second and the last: a denoiser's error falls slowly.
        ways += [Denoised(guided, k) for k in sorted({*counts[::2], counts[-1]})]
    return ways


def _provenance() -> dict[str, Any]:
    """Where and with what this ran."""
    from reference.variant import mitsuba
    from reports.run.bench.path_traced import SAMPLER

    found = {}
    for name in PACKAGES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "none"
    return {
        "device": device().name,
        "opengl": device().version,
        "hardware_gpu": device().hardware,
        "variant": mitsuba().variant(),
        "sampler": SAMPLER,
        "cpus": os.cpu_count(),
        "machine": f"{platform.machine()}, {platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "versions": found,
    }
