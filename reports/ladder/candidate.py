"""What a candidate drew of a case, on its way up the ladder."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from reports.ladder.rungs import Terms


@dataclass(frozen=True)
class Drawn:
    """A candidate's picture of a case, and the same with single switches thrown.

    Attributes:
        whole: linear radiance, (H, W, 3).
        specular: the same without the light of the diffuse lobe; None where it cannot be had.
        refined: the same with one precomputed map free of its own error, by the map's name.
    """

    whole: np.ndarray
    specular: np.ndarray | None = None
    refined: dict[str, np.ndarray] = field(default_factory=dict)


class Candidate:
    """A candidate on its way up the ladder: its pictures by name, and sums of them.

    Args:
        drawn: what stands against each truth; the same object where no switch parts them.
    """

    def __init__(self, drawn: Mapping[str, Drawn]) -> None:
        first: dict[int, str] = {}
        self.name = {truth: first.setdefault(id(d), f"R {truth}") for truth, d in drawn.items()}
        self.drawn = {self.name[truth]: d for truth, d in drawn.items()}

    def fits(self, ids: np.ndarray) -> bool:
        """Whether every picture is of the size of `ids`, (H, W), and finite."""
        wholes = [d.whole for d in self.drawn.values()]
        return all(w.shape[:2] == ids.shape and np.isfinite(w).all() for w in wholes)

    def switched(self, below: str, above: str) -> bool:
        """Whether a switch parts what stands against two truths."""
        return self.name[below] != self.name[above]

    def error(self, truth: str) -> Terms:
        """What it is wrong by against a truth."""
        return (1, self.name[truth]), (-1, truth)

    def diffuse_error(self, truth: str) -> Terms | None:
        """The same of its own diffuse light; None where that is unknown."""
        own = self._diffuse(truth)
        return None if own is None else (*own, (-1, f"{truth}.diffuse"))

    def step(self, below: str, above: str) -> Terms:
        """What it moves by from one truth to the next; nothing where no switch parts them."""
        if not self.switched(below, above):
            return ()
        return (1, self.name[above]), (-1, self.name[below])

    def diffuse_step(self, below: str, above: str) -> Terms | None:
        """The same of its diffuse light; None where that is unknown."""
        if not self.switched(below, above):
            return ()
        ends = self._diffuse(above), self._diffuse(below)
        if ends[0] is None or ends[1] is None:
            return None
        return (*ends[0], *((-sign, name) for sign, name in ends[1]))

    def pictures(self) -> dict[str, np.ndarray]:
        """All of them, (H, W, 3): whole, without the diffuse lobe, with a map made finely."""
        found = {name: d.whole for name, d in self.drawn.items()}
        for name, d in self.drawn.items():
            if d.specular is not None:
                found[f"{name}.specular"] = d.specular
            found |= {f"{name}.{fine}": rgb for fine, rgb in d.refined.items()}
        return found

    def _diffuse(self, truth: str) -> Terms | None:
        name = self.name[truth]
        return None if self.drawn[name].specular is None else ((1, name), (-1, f"{name}.specular"))
