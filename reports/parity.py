"""Conformance: what each run shows about the two sides drawing the same thing.

For our own techniques the gate judges these checks too; of an outside candidate, which may draw
another model or filter its pixels in another way, they are told.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy import ndimage

from reports.conformance.result import Conformance
from reports.results import Row
from reports.stability.agreement import TOLERANCE, Agreement
from scenes.frame import Frame
from scenes.schema import Case

SILHOUETTE = 0.98  # IoU of masks at pixel centres; the rim of a 10,000-pixel disc is 4 % of it
TIES = 4  # pixels that rays and rasterisation may round apart, however small the object
BACKGROUND = 0.01  # median relative difference of the environment behind the objects


@dataclass
class Checks:
    """Gathers agreement between the sides as a run goes on: figure, place.

    Attributes:
        judged: whether the gate fails on a check that fails.
        silhouettes: overlap, and how many pixels of the object differ.
    """

    judged: bool = True
    silhouettes: list[tuple[float, float, str]] = field(default_factory=list)
    backgrounds: list[tuple[float, str]] = field(default_factory=list)
    shaders: list[Agreement] = field(default_factory=list)
    definitions: list[Conformance] = field(default_factory=list)

    def add_frame(
        self, case: Case, technique: str, frame: Frame, truth: Frame, rows: list[Row]
    ) -> None:
        """Take in one frame beside one truth of its case, and its rows."""
        if frame.rgb.shape != truth.rgb.shape:
            return
        self.silhouettes += [
            (r.silhouette, (1 - r.silhouette) * r.pixels, f"{r.object} in {case.id}")
            for r in rows
            if r.silhouette >= 0
        ]
        sky = ndimage.binary_erosion(truth.ids == 0, iterations=5)
        if self.judged and sky.sum() > 100:  # who is outside may leave it black
            # Over 4x4 pixels: where things are, not how each side filters fine texels.
            ours, theirs = (
                ndimage.uniform_filter(f.rgb.mean(axis=2), 4)[sky] for f in (frame, truth)
            )
            difference = np.median(np.abs(ours - theirs) / np.maximum(theirs, 1e-6))
            self.backgrounds.append((float(difference), f"{technique} in {case.id}"))

    def verdicts(self) -> list[dict[str, Any]]:
        """Each check that could be made: name, passed, detail with the worst place."""
        made = []
        if self.silhouettes:
            worst, _, place = min(self.silhouettes)
            passed = all(o >= SILHOUETTE or apart <= TIES for o, apart, _ in self.silhouettes)
            detail = f"masks overlap by {worst:.2%} at worst ({place})"
            made.append(_verdict("silhouettes", passed, detail))
        if self.backgrounds:
            worst, place = max(self.backgrounds)
            detail = f"median difference {worst:.2%} at worst ({place})"
            made.append(_verdict("background", worst <= BACKGROUND, detail))
        if self.shaders:
            worst = max(self.shaders, key=lambda a: a.worst)
            detail = (
                f"the shaders' BRDF is off by {worst.worst:.1e} at worst against double precision "
                f"(alpha {worst.alpha:.3g}, weight {worst.weight:g}; allowed {TOLERANCE:.0e})"
            )
            made.append(_verdict("BRDF", worst.passed, detail))
        for d in self.definitions:
            detail = f"off by {d.off:.1e} at worst ({d.place}; allowed {d.allowed:.0e})"
            made.append(_verdict(d.name, d.passed, detail))
        return [check | {"judged": self.judged} for check in made]


def _verdict(name: str, passed: bool, detail: str) -> dict[str, Any]:
    return {"name": name, "passed": bool(passed), "detail": detail}
