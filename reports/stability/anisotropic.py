"""Facets with a direction in double precision, as `reports.stability.oracle` has others.

Directions are (n, 3) with x along the tangent; alpha is (2,), along it and across. By stretching
(Heitz 2014, 5.3): a slope counts in units of alpha, and a direction's tangent times alpha.
"""

import numpy as np

from reports.stability import oracle
from reports.stability.fresnel import fresnel_of
from scenes.schema import Material, Model

Pair = tuple[float, float]


def stretched(h: np.ndarray, alpha: Pair) -> np.ndarray:
    """tan²(theta) of h over alpha², (n,)."""
    slopes = h[:, :2].astype(float) / h[:, 2:] / alpha
    return (slopes**2).sum(axis=1)


def D_ggx(h: np.ndarray, alpha: Pair) -> np.ndarray:
    """Heitz 2014, eq. 85, (n,)."""
    return 1 / (np.pi * alpha[0] * alpha[1] * h[:, 2] ** 4 * (1 + stretched(h, alpha)) ** 2)


def D_beckmann(h: np.ndarray, alpha: Pair) -> np.ndarray:
    """Walter et al. 2007, eq. 25, stretched, (n,)."""
    return np.exp(-stretched(h, alpha)) / (np.pi * alpha[0] * alpha[1] * h[:, 2] ** 4)


def G1_smith(w: np.ndarray, alpha: Pair, weight: Pair = (1, 0)) -> np.ndarray:
    """Of a mixture, (n,): the width is that along w's azimuth (Heitz 2014, eq. 80)."""
    wide = np.hypot(*(w[:, :2].astype(float) * alpha).T) / w[:, 2]
    lobes = weight[0] * oracle.lambda_ggx(wide, 1.0) + weight[1] * oracle.lambda_beckmann(wide, 1.0)
    return 1 / (1 + lobes)


def brdf(material: Material, wi: np.ndarray, wo: np.ndarray, model: Model) -> np.ndarray:
    """f without the cosine, (n, 3), of a material of numbers alone, with kd = 1 - F."""
    h, wo_h = oracle.half_vector(wi, wo)
    alpha, share, share_g = material.alphas, material.weight, material.masking_weight
    D = share * D_ggx(h, alpha) + (1 - share) * D_beckmann(h, alpha)
    if model.masking == "smith":
        G = np.prod([G1_smith(w, alpha, (share_g, 1 - share_g)) for w in (wi, wo)], axis=0)
    else:
        G = share_g * G1_smith(wi, alpha) * G1_smith(wo, alpha)
        G += (1 - share_g) * oracle.G_vcavity(wi, wo)
    F = fresnel_of(material, model)(wo_h)
    cosines = 4 * wi[:, 2].astype(float) * wo[:, 2]
    return F * (D * G / cosines)[:, None] + (1 - F) * np.array(material.diffuse_albedo) / np.pi
