"""How far apart two evaluations of one function are."""

from dataclasses import dataclass

import numpy as np

from scenes.schema import Material

TOLERANCE = 1e-4  # of max(|f|, 1e-4 of the lobe's peak)
FLOOR = 1e-4


@dataclass(frozen=True)
class Agreement:
    """The worst difference between two evaluations of one material.

    Attributes:
        worst: |difference| over max(|f|, 1e-4 of the lobe's peak).
        wi, wo: the directions where it is found, in the tangent frame.
    """

    alpha: float
    weight: float
    masking: str
    beside: str
    worst: float
    wi: tuple[float, float, float]
    wo: tuple[float, float, float]

    @property
    def passed(self) -> bool:
        """Whether the difference is within TOLERANCE."""
        return self.worst <= TOLERANCE


def agreement(
    material: Material,
    masking: str,
    beside: str,
    ours: np.ndarray,
    theirs: np.ndarray,
    wi: np.ndarray,
    wo: np.ndarray,
) -> Agreement:
    """The worst difference of two evaluations (n, 3); NaN counts as infinite."""
    scale = np.maximum(np.abs(theirs), FLOOR * np.abs(theirs).max(axis=0))
    off = np.nan_to_num(np.abs(ours - theirs) / scale, nan=np.inf).max(axis=1)
    at = int(off.argmax())
    return Agreement(
        material.alpha,
        material.weight,
        masking,
        beside,
        float(off[at]),
        tuple(wi[at].tolist()),
        tuple(wo[at].tolist()),
    )
