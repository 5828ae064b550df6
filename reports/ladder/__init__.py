"""Error by cause: how far each thing that a real-time renderer leaves out takes it from the truth.

The truths T1 to T4 are a ladder: without visibility, with shadows, with full transport, with
physical materials. R1 to R4 are the candidate with what each truth has switched on, the same
picture where it has no such switch, and E_k = R_k - T_k. Then integration = E1,
occlusion = E2 - E1, interreflection = E3 - E2 and model = E4 - E3 sum to the total error E4. Each
is a signed sum of pictures, so integration and model can be split further wherever there is a
picture in between.

Each reference's batches are halved. Steps that follow each other come from different halves, and
the total from another than the last, so that no rung cancels and batches that do not agree keep the
sum from closing. (A rung that is wrong alike in all its batches is not seen: it moves error from
one cause to the next.)
"""

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from reports.ladder.candidate import Candidate, Drawn
from reports.ladder.lacking import lacking
from reports.ladder.rungs import MODEL_STEPS, NAMES, RUNGS, Terms, rungs_of
from reports.ladder.steps import places, steps_of
from reports.ladder.sums import Energy, Local, pictures_of
from reports.metrics.energy import block_sums
from reports.noise import Estimate
from reports.results import Cause, Figured, Ladder, Row
from scenes.frame import Frame
from scenes.schema import Case, Object

__all__ = ["MODEL_STEPS", "NAMES", "RUNGS", "Drawn", "ladder", "rungs_of"]
FEWEST = 4  # batches of each reference: two in each half
CLOSURE = 0.9999  # confidence of a gap, so that the hundred gaps of a suite close but by 1 %


def ladder(
    case: Case,
    obj: Object,
    technique: str,
    drawn: Mapping[str, Drawn],
    truths: dict[str, list[Frame]],
    rows: Iterable[Row],
) -> Ladder | None:
    """The causes of one object's error; None where there are too few rungs or batches for it.

    Args:
        drawn: what stands against each of the truths; the same object where no switch parts them.
        truths: batches by truth, each with the layer `diffuse` where it was told apart (else
            `drawn` has no `specular`); under the names in MODEL_STEPS those of the models in
            between `global` and `physical`.
        rows: the object's rows, one a truth, for the steps of SSIM.
    """
    rungs = rungs_of(truths)
    if not rungs:
        return None
    ids = truths[rungs[0]][0].ids
    mask = ids == case.index(obj.name)
    candidate = Candidate(drawn)
    if not candidate.fits(ids) or not mask.any() or min(map(len, truths.values())) < FEWEST:
        return None
    last, whole = rungs[-1], candidate.error(rungs[-1])
    steps = [*steps_of(rungs, candidate, truths)]
    pixels = pictures_of(candidate, truths, lambda rgb: rgb[mask].mean(axis=1, dtype=np.float64))
    blocks = pictures_of(candidate, truths, lambda rgb: block_sums(rgb, mask))
    covered = block_sums(mask[..., None], mask)
    other = 1 - steps[-1].half
    energy, local = Energy(pixels, last), Local(blocks, covered, whole, other)
    ssim = {r.truth: Estimate(r.ssim, r.ssim_se, r.ssim_dof) for r in rows}
    causes = [
        Cause(
            name=step.name,
            parent=step.parent,
            energy=_figured(energy.of(step.terms, step.half)),
            diffuse=_diffuse(energy, step.diffuse, step.half),
            local=_figured(local.share(step.terms, step.half)),
            ssim=_ssim_step(step.name, rungs, ssim),
        )
        for step in steps
    ]
    top = [
        [t for s in steps if s.half == half and not s.parent for t in s.terms] for half in (0, 1)
    ]
    gaps = energy.gap(top, whole, other), local.gap(top)
    lacked = lacking(blocks, covered, candidate) if "global" in rungs else {}
    return Ladder(
        case=case.id,
        object=obj.name,
        technique=technique,
        truth=last,
        switched=[n for n, (a, b) in places(rungs).items() if candidate.switched(a, b)],
        causes=causes,
        total=Cause(
            name="total",
            energy=_figured(energy.of(whole, other)),
            diffuse=_diffuse(energy, candidate.diffuse_error(last), other),
            local=_figured(local.total),
            ssim=_figured(_less(ssim.get(last), Estimate(1.0))),
        ),
        energy_gap=_figured(gaps[0]),
        local_gap=_figured(gaps[1]),
        closes=all(low <= 0 <= high for low, high in (g.interval(CLOSURE) for g in gaps)),
        missing={n: _figured(e) for n, e in lacked.items()},
    )


def _ssim_step(name: str, rungs: Sequence[str], ssim: dict[str, Estimate]) -> Figured | None:
    """How much SSIM moves from one rung to the next; only whole causes have such a step."""
    if name not in NAMES:
        return None
    place = NAMES.index(name)
    before = ssim.get(rungs[place - 1]) if place else Estimate(1.0)
    return _figured(_less(ssim.get(rungs[place]), before))


def _diffuse(energy: Energy, terms: Terms | None, half: int) -> Figured | None:
    if terms is None or any(name not in energy.pictures.cells for _, name in terms):
        return None
    return _figured(energy.of(terms, half))


def _less(a: Estimate | None, b: Estimate | None) -> Estimate:
    """a - b of independent estimates."""
    if a is None or b is None:
        return Estimate(math.nan, math.nan)
    known = [e.dof for e in (a, b) if e.se > 0]
    return Estimate(a.value - b.value, math.hypot(a.se, b.se), min(known, default=0.0))


def _figured(estimate: Estimate) -> Figured:
    low, high = estimate.interval()
    return Figured(value=estimate.value, low=low, high=high)
