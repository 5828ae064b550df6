"""What the path tracer is worth: time to the same intervals, ours beside a plain one."""

from reference.batches import render_batch, truth_of
from reference.settings import FEWEST_BATCHES, TRUTHS, rounded_samples
from reference.timing import pilot_seconds
from reports.efficiency import Efficiency, efficiencies
from reports.progress import reporting
from reports.run.job import Job


def efficiency(job: Job) -> list[Efficiency]:
    """Time to the same intervals, ours beside the plain path tracer's."""
    from reference.plain import plain_batches

    found, samples = [], job.suite.reference.samples_per_batch
    truths = TRUTHS["model"]
    with reporting((1 + len(truths)) * len(job.entries)) as report:
        for entry in job.entries:
            case = entry.case
            shot = next(iter(job.pictures(entry).values()))
            report.step(f"{case.id}: ours, beside {shot.name}")
            frame = shot.candidate.render(shot.case)
            render_batch(case, "model", samples, 0)  # compiles and warms up
            batches = [render_batch(case, "model", samples, 1 + k) for k in range(FEWEST_BATCHES)]
            ours = {t: [truth_of(b, t) for b in batches] for t in truths}
            taken, plain = rounded_samples(samples), {}
            for truth in truths:
                report.step(f"{case.id}: plain path tracing of {truth}")
                plain[truth] = plain_batches(case, truth, taken, FEWEST_BATCHES)
            found += efficiencies(case, frame, ours, plain, pilot_seconds(case))
    return found
