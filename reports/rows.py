"""Rows: what is known of every judged object of a case, candidate by candidate."""

from collections.abc import Sequence
from typing import Any

from reports import gate
from reports.compare import Truth, compare
from reports.results import Row
from scenes.frame import Frame
from scenes.schema import Case, Object
from scenes.suite import Budget

ENOUGH_PIXELS = 10_000  # below, blocks are few and SSIM's windows are mostly rim


def judged_rows(
    case: Case,
    truth: Truth,
    frames: dict[str, Frame],
    failures: dict[str, str],
    rules: Sequence[Budget],
    family: int = 1,
) -> list[Row]:
    """The rows of a case against one truth, with their verdicts.

    Args:
        frames: the candidates' pictures by technique.
        failures: why a technique gave no picture; its rows fail with that problem.
        rules: the suite's budgets. None holds against `physical` and `physical-smith`: they draw
            another model than the paper's, so such rows are told and never judged.
        family: how many verdicts must hold together (`gate.family_size`).
    """
    rules = [] if truth.name.startswith("physical") else list(rules)
    rows = [
        Row(**_identity(case, obj, label), **_cost(truth), problem=problem)
        for label, problem in failures.items()
        for obj in case.judged
    ]
    for label, frame in frames.items():
        made = frame.provenance.get("precomputation_seconds", float("nan"))
        times = {"frame_ms": frame.seconds * 1e3, "precomputation_ms": made * 1e3}
        for obj, figures in compare(case, frame, truth):
            few = _few_pixels(obj, figures.get("pixels", 0))
            rows.append(
                Row(**_identity(case, obj, label), **_cost(truth), **times, **figures, note=few)
            )
    return [gate.judge(row, rules, family) for row in rows]


def _few_pixels(obj: Object, pixels: int) -> str:
    """What to know of an object whose figures rest on few pixels, with its own reason if given."""
    if pixels >= ENOUGH_PIXELS:
        return ""
    why = obj.small or "see `small` in scenes/FORMAT.md"
    return f"covers {pixels:,} pixels, under {ENOUGH_PIXELS:,}: {why}"


def _identity(case: Case, obj: Object, technique: str) -> dict[str, Any]:
    """The fields of a row that say what it is about."""
    material = obj.material
    return {
        "case": case.id,
        "scene": case.scene,
        "environment": case.environment.name,
        "object": obj.name,
        "material": material.name,
        "roughness": material.roughness,
        "metallic": material.metallic,
        "weight": material.weight,
        "weight_g": material.masking_weight,
        "technique": technique,
    }


def _cost(truth: Truth) -> dict[str, Any]:
    """The fields of a row that say which truth it stands against, and what that took."""
    return {
        "truth": truth.name,
        "reference_seconds": sum(b.seconds for b in truth.batches),
        "reference_spp": sum(b.provenance["samples"] for b in truth.batches),
        "reference_batches": len(truth.batches),
    }
