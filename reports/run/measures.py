"""What either renderer is worth on its own: noise, and the BRDF direction by direction."""

from reference import probe as reference_probe
from reference.batches import render_batch, truth_of
from reference.settings import FEWEST_BATCHES, TRUTHS, rounded_samples
from reference.timing import pilot_seconds
from renderer import probe
from reports.efficiency import Efficiency, efficiencies
from reports.progress import reporting
from reports.run.job import Job
from reports.stability.agreement import Agreement, agreement
from reports.stability.directions import MASKINGS, directions, materials
from reports.stability.oracle import oracle
from scenes.schema import Material, Model


def efficiency(job: Job) -> list[Efficiency]:
    """Time to the same intervals, ours beside the plain path tracer's."""
    from reference.plain import plain_batches

    found, samples = [], job.suite.reference.samples_per_batch
    truths = TRUTHS["model"]
    with reporting((1 + len(truths)) * len(job.entries)) as report:
        for entry in job.entries:
            case = entry.case
            label, candidate = next(iter(job.candidates(entry).items()))
            report.step(f"{case.id}: ours, beside {label}")
            frame = candidate.render(case)
            render_batch(case, "model", samples, 0)  # compiles and warms up
            batches = [render_batch(case, "model", samples, 1 + k) for k in range(FEWEST_BATCHES)]
            ours = {t: [truth_of(b, t) for b in batches] for t in truths}
            taken, plain = rounded_samples(samples), {}
            for truth in truths:
                report.step(f"{case.id}: plain path tracing of {truth}")
                plain[truth] = plain_batches(case, truth, taken, FEWEST_BATCHES)
            found += efficiencies(case, frame, ours, plain, pilot_seconds(case))
    return found


def beside_oracle(material: Material, model: Model) -> Agreement:
    """The GLSL BRDF of a material beside double precision."""
    wi, wo = directions(material.alpha)
    ours = probe.brdf_values(material, wi, wo, model)
    theirs = oracle(material, wi, wo, model.masking)
    return agreement(material, model.masking, "double precision", ours, theirs, wi, wo)


def stability() -> list[Agreement]:
    """The GLSL BRDF beside double precision and Mitsuba, over maskings, alphas and weights."""
    found = []
    surfaces = [(Model(masking=masking), m) for masking in MASKINGS for m in materials()]
    with reporting(len(surfaces)) as report:
        for model, material in surfaces:
            share = f"GGX share {material.weight:g}"
            report.step(f"masking {model.masking}, alpha {material.alpha:g}, {share}")
            wi, wo = directions(material.alpha)
            ours = probe.brdf_values(material, wi, wo, model)
            theirs = reference_probe.brdf_values(material, wi, wo, model)
            found.append(beside_oracle(material, model))
            found.append(agreement(material, model.masking, "Mitsuba", ours, theirs, wi, wo))
    return found
