"""References: traced ahead, told, and pooled."""

import math

import numpy as np

from reference.batches import Task, grow, lacking, prefetch, render_batch
from reference.settings import FEWEST_BATCHES, rounded_samples
from reference.store import Store
from reports.calibration import Pool
from reports.progress import reporting
from reports.run.job import Job, make_folder, sources
from reports.run.own_truths import own_files
from reports.run.shipped import need_stored
from scenes.suite import Entry


def references(job: Job, samples: int) -> list[tuple[str, str, int, float]]:
    """Path-trace every reference of a job to at least `samples` per pixel.

    Returns:
        Per reference: case, truths, samples per pixel, seconds of path tracing in total.
    """
    sampling, store = job.suite.reference, Store(job.store)
    if job.frozen:
        need_stored(job)
    else:
        most = sampling.max_samples // sampling.samples_per_batch
        reached = math.ceil(samples / rounded_samples(sampling.samples_per_batch))
        trace_ahead(job, max(min(reached, most), FEWEST_BATCHES))
    done = []
    for source in (s for e in job.entries for s in sources(e)):
        case, kind = source.case, source.kind
        stored = grow(case, kind, sampling, lambda _: True, store, None, job.executor, job.frozen)
        spp = sum(b.provenance["samples"] for b in stored)
        named = ", ".join(source.truths)
        done.append((case.id, named, spp, sum(b.seconds for b in stored)))
    return done


def trace_ahead(job: Job, count: int) -> None:
    """See to it that every reference of a job has `count` batches, all submitted at once."""
    make_folder(job.store, "--store")
    store, sampling = Store(job.store), job.suite.reference
    needed = [s for e in job.entries for s in sources(e)]
    tasks = lacking([(s.case, s.kind, sampling, count) for s in needed], store)
    with reporting(len(tasks)) as report:

        def stored(task: Task) -> None:
            report.step(f"{task.case.id}: {task.kind}, batch {task.number} is stored")

        prefetch(tasks, store, job.executor, stored)


def plan(job: Job) -> list[str]:
    """What `run` would do, a line each: pictures to draw and samples to trace."""
    lines, store = [], Store(job.store)
    for entry in job.entries:
        case, names = entry.case, ", ".join(job.pictures(entry))
        lines.append(
            f"{case.id}: {case.width}x{case.height}, {len(case.judged)} objects, draw {names}"
        )
        if job.truth:
            lines += _own(job, entry)
            continue
        for source in sources(entry):
            batches = store.load(source.case, source.kind, job.suite.reference)
            there = sum(b.provenance["samples"] for b in batches)
            most, named = job.suite.reference.max_samples, ", ".join(source.truths)
            lines.append(
                f"  {named}: {there} samples per pixel in the store, at most {most} needed"
            )
    return lines


def _own(job: Job, entry: Entry) -> list[str]:
    counts = {truth: len(own_files(job.truth, entry.case, truth)) for truth in entry.truths}
    return [f"  {truth}: {count} batches in {job.truth}" for truth, count in counts.items()]


def pools(job: Job) -> list[Pool]:
    """Each case's `global` batches at the cap of samples, and eight of one sample per pixel."""
    made = []
    with reporting(len(job.entries)) as report:
        for entry in job.entries:
            case = entry.case
            report.step(f"{case.id}: trace a pool of batches")

            def traced(done: int, wanted: int, name: str = case.id) -> None:
                report.detail(f"{name}: batch {done} of {wanted}")

            frames = grow(
                case, "model", job.suite.reference, lambda _: False, Store(job.store), traced
            )
            coarse = np.stack([render_batch(case, "model", 1, seed).rgb for seed in range(8)])
            obj = case.judged[0]
            mask = frames[0].ids == case.index(obj.name)
            batches = np.stack([frame.rgb for frame in frames])
            name = f"{obj.material.name}, {case.environment.name}"
            made.append(Pool(name, batches, mask, coarse))
    return made
