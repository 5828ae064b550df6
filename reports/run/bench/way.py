"""A way to draw a case: a technique, or a path tracer at some samples per pixel."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from math import nan
from typing import Literal

import numpy as np

from reports.speed.points import Change, Family
from scenes.schema import Case, Material

SHARES = (0.5, 0.25, 0.6, 0.4)  # GGX shares to change between; at the ends a lobe is left out


@dataclass(frozen=True)
class Cost:
    """What a way costs besides its warm frames; the fields are those of reports.speed.Point."""

    compilation: float = 0.0
    precomputation: float = 0.0
    preparation: float = 0.0
    after: dict[Change, float] = field(default_factory=dict)
    memory: float = nan
    held: float = nan


class Way(ABC):
    """One way to draw a case, ready to be timed.

    Attributes:
        family, name, samples: as in reports.speed.Point.
        noisy: whether each frame is another picture.
    """

    family: Family
    name: str
    samples: int = 0
    noisy: bool = False

    @abstractmethod
    def frame(self, seed: int) -> float:
        """Seconds until one more frame is finished."""

    @abstractmethod
    def picture(self) -> np.ndarray:
        """The last frame, (H, W, 3) linear radiance."""

    @abstractmethod
    def cost(self, frame: float) -> Cost:
        """What stands beside the frames, of which a warm one takes `frame` seconds."""

    def gpu_frames(self, count: int) -> list[float]:
        """Seconds of so many frames on the GPU's own clock, where there is one."""
        return []

    def close(self) -> None:  # noqa: B027  most hold nothing
        """Give back what it holds."""


def changed(case: Case, change: Literal["material", "weight"], step: int = 0) -> Case:
    """The case after a change of all its materials; another one for each step from 0 to 3.

    `material` moves roughness and albedo, which are numbers to a shader; `weight` moves the share
    of GGX between its ends, for at the ends one lobe is compiled out.
    """

    def material(old: Material) -> Material:
        if change == "weight":
            return old.model_copy(update={"weight": SHARES[step], "weight_g": None})
        factor = 1 - 0.02 * (step + 1)
        albedo = tuple(factor * a for a in old.albedo)
        return old.model_copy(update={"roughness": factor * old.roughness, "albedo": albedo})

    objects = (o.model_copy(update={"material": material(o.material)}) for o in case.objects)
    return case.model_copy(update={"objects": tuple(objects)})
