"""How wrong a picture is against `global`, and how wrong a way is that draws another each time."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reports.compare import Truth, compare
from reports.metrics import JUDGED
from reports.metrics.energy import rooted
from reports.noise import Estimate
from reports.results import Figured
from reports.speed.points import Error
from scenes.frame import Frame
from scenes.schema import Case, Object


@dataclass(frozen=True)
class Judged:
    """The figures of one picture of one object, with the noise that the truth brings to them.

    Attributes:
        energy_error: signed.
        local_square: the square of energy_local.
        one_minus_ssim: 1 - SSIM.
        problem: why there are none.
    """

    energy_error: Estimate
    local_square: Estimate
    one_minus_ssim: Estimate
    problem: str = ""


def judged(case: Case, obj: Object, picture: np.ndarray, truth: Truth) -> Judged:
    """Measure a picture (H, W, 3) of a case on one of its objects."""
    found = compare(case, obj, Frame(picture), truth, JUDGED)

    def estimate(value: float, name: str) -> Estimate:
        return Estimate(value, found.get(f"{name}_se", math.nan), found.get(f"{name}_dof", 0.0))

    return Judged(
        estimate(found.get("energy_error", math.nan), "energy"),
        estimate(found.get("energy_local", math.nan) ** 2, "energy_local"),
        estimate(1 - found.get("ssim", math.nan), "ssim"),
        found.get("problem", ""),
    )


def pooled(pictures: Sequence[Estimate]) -> Estimate:
    """The mean over pictures of different seeds, with their spread and the truth's noise in it.

    All pictures share the truth, so its noise does not average out. Degrees of freedom by Welch
    and Satterthwaite (1946, 1947).
    """
    values = np.array([p.value for p in pictures])
    noise, dof = np.mean([p.se for p in pictures]), np.mean([p.dof for p in pictures])
    if len(values) == 1:
        return Estimate(float(values[0]), float(noise), float(dof))
    parts = np.array([values.var(ddof=1) / len(values), noise**2])
    degrees = np.array([len(values) - 1, max(dof, 1)])
    total = parts.sum()
    together = total**2 / np.sum(parts**2 / degrees) if total > 0 else degrees[0]
    return Estimate(float(values.mean()), math.sqrt(total), float(together))


def error_of(obj: Object, pictures: Sequence[Judged]) -> Error:
    """The record of a way's error on one object, from one or more of its pictures."""
    material = obj.material
    energy = pooled([p.energy_error for p in pictures])
    unlike = pooled([p.one_minus_ssim for p in pictures])
    local = rooted(pooled([p.local_square for p in pictures]))
    return Error(
        object=obj.name,
        material=material.name,
        roughness=material.roughness,
        weight=material.weight,
        energy_error=_figured(energy.value, *energy.interval()),
        energy_local=_figured(*local),
        one_minus_ssim=_figured(unlike.value, *unlike.interval()),
    )


def _figured(value: float, low: float, high: float) -> Figured:
    return Figured(value=value, low=low, high=high)
