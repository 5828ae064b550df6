"""How far apart two evaluations of one function are."""

from dataclasses import dataclass

import numpy as np

from scenes.schema import Material

TOLERANCE = 1e-4  # of max(|f|, 1e-4 of the lobe's peak)
FLOOR = 1e-4
BINS = 10 ** np.linspace(-4, 0, 33)[1:-1]  # of n.v, eight a decade; ends hold what lies beyond


def off_by(ours: np.ndarray, theirs: np.ndarray, peak: np.ndarray | float) -> np.ndarray:
    """|ours - theirs| over max(|theirs|, 1e-4 of the peak); what is no number counts as infinite.

    Args:
        ours, theirs, peak: broadcast together; the peak is the lobe's, at least 0.
    """
    ours, size = ours.astype(float), np.abs(theirs.astype(float))
    with np.errstate(all="ignore"):
        off = np.abs(ours - theirs) / np.maximum(np.maximum(size, FLOOR * peak), 1e-300)
    return np.where(np.isfinite(ours), off, np.inf)


def peaks(f: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """The largest |f| of all pairs in the same bin of n.v, (n, parts).

    At grazing angles it is up to 1e8 times what it is from above: one peak for all would hide
    whatever is wrong there.

    Args:
        f: (n, parts).
        cosine: n.v of each pair, (n,).
    """
    bins = np.digitize(cosine, BINS)
    largest = np.zeros((len(BINS) + 1, f.shape[1]))
    np.maximum.at(largest, bins, np.abs(f))
    return largest[bins]


@dataclass(frozen=True)
class Agreement:
    """The worst difference between two evaluations of one material.

    Attributes:
        worst: |difference| over max(|f|, 1e-4 of the lobe's peak at such an n.v).
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
    off = off_by(ours, theirs, peaks(theirs, wo[:, 2])).max(axis=1)
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
