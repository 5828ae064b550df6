"""Comparison: one candidate against one truth, object by object."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from reports.display import FAINTEST, exposure_for
from reports.metrics import METRICS, Metric
from reports.metrics.subject import Subject, TruthView, crop_of
from scenes.frame import Frame
from scenes.schema import Case, Object


class Truth:
    """A truth of a case: its batches, and each judged object cut out of them.

    Args:
        case: what was drawn.
        name: which of the truths.
        batches: at least one Frame with ids, all of one size.
        exposures: display scale by object name (`exposures_of` the `global` truth).
    """

    def __init__(
        self, case: Case, name: str, batches: list[Frame], exposures: dict[str, float]
    ) -> None:
        self.name, self.batches, self.ids = name, batches, batches[0].ids
        self.crops, self.views = {}, {}
        for obj in case.judged:
            mask = self.ids == case.index(obj.name)
            if not mask.any():
                continue
            crop = self.crops[obj.name] = crop_of(mask)
            pixels = np.stack([batch.rgb[crop] for batch in batches])
            corner = (crop[0].start, crop[1].start)
            self.views[obj.name] = TruthView(pixels, mask[crop], exposures[obj.name], corner)


def exposures_of(case: Case, batches: list[Frame]) -> dict[str, float]:
    """The display scale of each judged object, from the first 8 batches of a truth.

    Only the first, so that a reference that grows keeps its exposure.
    """
    mean = np.mean([b.rgb for b in batches[:8]], axis=0)
    return {o.name: exposure_for(mean, batches[0].ids == case.index(o.name)) for o in case.judged}


def compare(
    case: Case, obj: Object, candidate: Frame, truth: Truth, metrics: Sequence[Metric] = METRICS
) -> dict[str, Any]:
    """The figures of a judged object, as fields of reports.results.Row.

    A picture that cannot be measured gives only `problem` and the counts that explain it.
    """
    view = truth.views.get(obj.name)
    if view is None:
        return {"problem": "the object covers no pixel of the truth"}
    if candidate.rgb.shape[:2] != truth.ids.shape:
        got, want = candidate.rgb.shape[1::-1], truth.ids.shape[::-1]
        return {"problem": f"is {got[0]}x{got[1]} pixels, not {want[0]}x{want[1]}"}
    if bad := int((~np.isfinite(candidate.rgb).all(axis=2)).sum()):
        own = candidate.rgb[truth.ids == case.index(obj.name)]
        return _counts(own) | {"problem": f"{bad} pixels of the picture hold NaN or Inf"}
    pixels = candidate.rgb[truth.crops[obj.name]]
    fields = _counts(pixels[view.mask]) | {"exposure": view.exposure}
    if candidate.ids is not None:
        overlap = _overlap(candidate.ids, truth.ids, case.index(obj.name))
        # Masks are exact, without noise.
        fields |= {"silhouette": overlap, "silhouette_ci95": (overlap, overlap)}
    if problem := _unusable(pixels, fields, view):
        return fields | {"problem": problem}
    subject = Subject(pixels, view)
    for figures in metrics:
        fields |= figures(subject)
    return fields


def _counts(pixels: np.ndarray) -> dict[str, int]:
    """How many of the object's pixels (p, 3) hold NaN, Inf or a negative value."""
    return {
        "pixels": len(pixels),
        "nan_pixels": int(np.isnan(pixels).any(axis=1).sum()),
        "inf_pixels": int(np.isinf(pixels).any(axis=1).sum()),
        "negative_pixels": int((pixels < 0).any(axis=1).sum()),
    }


def _unusable(pixels: np.ndarray, counts: dict[str, int], view: TruthView) -> str:
    """Why an object's pixels cannot be measured, or nothing."""
    if not view.core.any():
        return f"covers {counts['pixels']} pixels and has no interior: too small for SSIM"
    own = pixels[view.mask]
    if not own.any() and view.mean[view.mask].any():
        return "is black where the truth is not"
    if below := int((own * view.exposure < -FAINTEST).any(axis=1).sum()):
        return f"{below} pixels of the object are below zero, by up to {-own.min():.2g}"
    return ""


def _overlap(ours: np.ndarray, theirs: np.ndarray, number: int) -> float:
    """Intersection over union of one object's mask in two id pictures."""
    a, b = ours == number, theirs == number
    return float((a & b).sum() / max((a | b).sum(), 1))
