"""The strip of trust: what each run shows about the two sides drawing the same thing."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy import ndimage

from reports.results import Row
from scenes.frame import Frame
from scenes.schema import Case

SILHOUETTE = 0.98  # IoU of masks at pixel centres; the edge of a 10,000-pixel object is 4 % of it
BACKGROUND = 0.01  # median relative difference: centre of a pixel against its average
ENERGY = 0.003  # `sampled` integrates the very model of `unoccluded`


@dataclass
class Checks:
    """Gathers agreement between the sides, frame by frame."""

    silhouette: list[tuple[float, str]] = field(default_factory=list)
    background: list[tuple[float, str]] = field(default_factory=list)
    energy: list[tuple[float, str]] = field(default_factory=list)

    def add(
        self,
        case: Case,
        technique: str,
        truth_name: str,
        frame: Frame,
        truth: Frame,
        rows: list[Row],
    ) -> None:
        """Take in one frame beside one truth of its case."""
        if frame.rgb.shape != truth.rgb.shape:
            return
        self.silhouette += [
            (r.silhouette, f"{case.id} {r.object}") for r in rows if r.silhouette >= 0
        ]
        sky = ndimage.binary_erosion(truth.ids == 0, iterations=3)
        if sky.sum() > 100:
            ours, theirs = frame.rgb[sky].mean(axis=1), truth.rgb[sky].mean(axis=1)
            difference = np.median(np.abs(ours - theirs) / np.maximum(theirs, 1e-6))
            self.background.append((float(difference), f"{case.id} {technique}"))
        if technique.startswith("sampled") and truth_name == "unoccluded":
            for row in rows:
                low, high = row.energy_ci95
                beyond = max(low, -high, 0.0)  # distance of the interval from no error at all
                self.energy.append((beyond, f"{case.id} {row.object}"))

    def verdicts(self) -> list[dict[str, Any]]:
        """Each check that could be made: name, passed, detail with the worst place."""
        made = []
        if self.silhouette:
            worst, place = min(self.silhouette)
            detail = f"masks overlap by {worst:.2%} at worst ({place})"
            made.append({"name": "silhouettes", "passed": worst >= SILHOUETTE, "detail": detail})
        if self.background:
            worst, place = max(self.background)
            detail = f"median difference {worst:.2%} at worst ({place})"
            made.append({"name": "background", "passed": worst <= BACKGROUND, "detail": detail})
        if self.energy:
            worst, place = max(self.energy)
            detail = f"sampled off unoccluded by {worst:.2%} beyond noise at worst ({place})"
            made.append({"name": "energy", "passed": worst <= ENERGY, "detail": detail})
        return made
