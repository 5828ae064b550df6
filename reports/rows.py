"""Rows: what is known of every judged object of a case, candidate by candidate."""

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

from reports import gate
from reports.compare import Truth, compare
from reports.metrics import FURTHER, JUDGED
from reports.results import Row
from scenes.frame import Frame
from scenes.schema import Case, Model, Object
from scenes.suite import Budget

SPREAD = 3  # batches that an interval takes; 8 give a good one
ENOUGH_PIXELS = 10_000  # below, blocks are few and SSIM's windows are mostly rim


@dataclass(frozen=True)
class Picture:
    """What a technique drew to stand against a truth.

    Attributes:
        name: in results.json; of one technique's pictures each has its own.
        model: that it was drawn under.
    """

    name: str
    frame: Frame
    model: Model


def judged_rows(
    case: Case,
    truth: Truth,
    pictures: Mapping[str, Picture],
    failures: dict[str, str],
    rules: Sequence[Budget],
    family: int = 1,
) -> list[Row]:
    """The rows of a case against one truth, with their verdicts and the figures these need.

    Args:
        pictures: what stands against this truth, by technique.
        failures: why a technique gave no picture; its rows fail with that problem.
        rules: the suite's budgets; of rows that `gate.judged_against` spares none holds.
        family: how many verdicts must hold together (`gate.family_size`).
    """
    rows = [
        Row(**_identity(case, obj, label), picture=label, **_cost(truth), problem=problem)
        for label, problem in failures.items()
        for obj in case.judged
    ]

    def row(label: str, obj: Object) -> Row:
        frame = pictures[label].frame
        made = frame.provenance.get("precomputation_seconds", float("nan"))
        times = {"frame_ms": frame.seconds * 1e3, "precomputation_ms": made * 1e3}
        figures = compare(case, obj, frame, truth, JUDGED)
        few = _few_pixels(obj, figures.get("pixels", 0)), _few_batches(truth)
        told = _identity(case, obj, label) | {"picture": pictures[label].name}
        return Row(**told, **_cost(truth), **times, **figures, note="; ".join(filter(None, few)))

    def held(row: Row) -> Row:
        drawn = pictures[row.technique].model if row.technique in pictures else case.model
        return gate.judge(row, rules if gate.judged_against(row.truth, drawn) else [], family)

    pairs = [(label, obj) for label in pictures for obj in case.judged]
    rows += _threaded(lambda pair: row(*pair), pairs)
    return [held(row) for row in rows]


def measured_further(
    case: Case, truths: Mapping[str, Truth], frames: Mapping[str, Frame], rows: Sequence[Row]
) -> list[Row]:
    """Rows with the figures that no verdict needs; `frames` by the names of pictures."""
    objects = {o.name: o for o in case.judged}

    def measured(row: Row) -> Row:
        if row.problem:
            return row
        further = compare(
            case, objects[row.object], frames[row.picture], truths[row.truth], FURTHER
        )
        return row.model_copy(update=further)

    return _threaded(measured, rows)


def _threaded(work: Callable[[Any], Row], items: Sequence[Any]) -> list[Row]:
    """Work on each item, in order; the filters that take the time let other threads run."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(work, items))


def _few_pixels(obj: Object, pixels: int) -> str:
    """What to know of an object whose figures rest on few pixels, with its own reason if given."""
    if pixels >= ENOUGH_PIXELS:
        return ""
    why = obj.small or "see `small` in scenes/FORMAT.md"
    return f"covers {pixels:,} pixels, under {ENOUGH_PIXELS:,}: {why}"


def _few_batches(truth: Truth) -> str:
    """What to know of figures that have no interval for want of batches."""
    count = len(truth.batches)
    return (
        "" if count >= SPREAD else f"{count} of the 8 batches that a reference needs: no interval"
    )


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
