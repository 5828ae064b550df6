"""Does the GLSL compute the model? Per direction, beside Mitsuba and double precision."""

from dataclasses import dataclass

import numpy as np
from scipy.special import erf

from scenes.schema import Material

TOLERANCE = 1e-4  # of max(|f|, 1e-4 of the lobe's peak)
FLOOR = 1e-4
ALPHAS = (0.01, 0.05, 0.16, 0.49, 1.0)
WEIGHTS = (0.0, 0.25, 0.5, 1.0)
MASKINGS = ("paper", "smith")


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


def materials() -> list[Material]:
    """Surfaces over alpha and weight, half metal so that every term counts."""
    return [
        Material(
            albedo=(0.6, 0.3, 0.05),
            roughness=np.sqrt(alpha),
            metallic=0.5,
            f0=0.04,
            metal="Cu",
            weight=weight,
        )
        for alpha in ALPHAS
        for weight in WEIGHTS
    ]


def directions(alpha: float, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of unit directions, two (n, 3) float32 arrays, many of them near the lobe's peak.

    Half of the pairs are spread over the hemisphere down to grazing angles; the others are
    mirrored about normals within a few alpha of n.
    """
    rng = np.random.default_rng(seed)
    count = 20_000
    cosine = np.concatenate(
        [rng.uniform(1e-3, 1, count // 2), 10 ** rng.uniform(-3, 0, count // 2)]
    )
    wo = _direction(cosine, rng.uniform(0, 2 * np.pi, count))
    spread = _direction(rng.permutation(cosine), rng.uniform(0, 2 * np.pi, count))
    tilt = np.minimum(alpha * 10 ** rng.uniform(-2, 0.7, count), 1.5)
    h = _direction(np.cos(tilt), rng.uniform(0, 2 * np.pi, count))
    mirrored = 2 * (wo * h).sum(axis=1, keepdims=True) * h - wo
    wi = np.where((np.arange(count) % 2 == 0)[:, None], spread, mirrored)
    above = wi[:, 2] > 1e-3
    return wi[above].astype(np.float32), wo[above].astype(np.float32)


def _direction(cosine: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
    sine = np.sqrt(1 - cosine**2)
    return np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine], axis=1)


def oracle(
    material: Material, wi: np.ndarray, wo: np.ndarray, masking: str = "paper"
) -> np.ndarray:
    """The model in double precision, f without the cosine, (n, 3): the definition itself.

    Cook and Torrance 1982; D and G1 of Walter et al. 2007, eq. 25, 33, 34; Schlick 1994; for the
    masking `smith` Heitz 2014, eq. 68 and 72.
    """
    wi, wo, alpha = wi.astype(float), wo.astype(float), material.alpha
    h = wi + wo
    # For unit directions wi.h is half the length of wi + wo. float32 directions are not quite
    # unit, and where both graze their dot product would magnify that to 5e-3.
    wi_h = np.linalg.norm(h, axis=1) / 2
    h /= 2 * wi_h[:, None]
    cos_i, cos_o, cos_h = wi[:, 2], wo[:, 2], h[:, 2]
    tan2 = (h[:, 0] ** 2 + h[:, 1] ** 2) / cos_h**2
    ggx = 1 / (np.pi * alpha**2 * cos_h**4 * (1 + tan2 / alpha**2) ** 2)
    beckmann = np.exp(-tan2 / alpha**2) / (np.pi * alpha**2 * cos_h**4)

    w, v = material.weight, material.masking_weight
    D = w * ggx + (1 - w) * beckmann
    if masking == "smith":
        G = 1 / (1 + Lambda(wi, alpha, v)) / (1 + Lambda(wo, alpha, v))
    else:
        smith = 1 / (1 + Lambda(wi, alpha, 1)) / (1 + Lambda(wo, alpha, 1))
        G = v * smith + (1 - v) * np.minimum(1, 2 * cos_h * np.minimum(cos_i, cos_o) / wi_h)
    f0, albedo = np.array(material.specular_f0), np.array(material.diffuse_albedo)
    F = f0 + (1 - f0) * ((1 - wi_h) ** 5)[:, None]
    return (1 - F) * albedo / np.pi + F * (D * G / (4 * cos_i * cos_o))[:, None]


def Lambda(w: np.ndarray, alpha: float, share: float) -> np.ndarray:
    """Smith's Lambda of GGX (by its share) and Beckmann mixed, (n,); 1 / G1 = 1 + Lambda.

    Heitz 2014, eq. 72 and 68; eq. 14 is linear in D, and so is Lambda.
    """
    a = w[:, 2] / (alpha * np.maximum(np.hypot(w[:, 0], w[:, 1]), 1e-100))
    ggx = (np.sqrt(1 + a**-2) - 1) / 2
    beckmann = (erf(a) - 1) / 2 + np.exp(-(a**2)) / (2 * a * np.sqrt(np.pi))
    return share * ggx + (1 - share) * beckmann


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
