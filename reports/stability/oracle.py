"""The model in double precision: what the shaders and Mitsuba are held against.

Directions are (n, 3) in the frame n = +z; alpha is a number or (n,). Inputs are read as they are:
given float32 values, they are those values and no others. Nothing cancels: sines come from the
components of a direction, not from its cosine, and half vectors from the sum of both.
"""

import numpy as np
from scipy.special import erf

from scenes.schema import Material

Alpha = float | np.ndarray


def half_vector(wi: np.ndarray, wo: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """h (n, 3) and h.wi (n,).

    For unit directions wi.h is half the length of wi + wo. float32 directions are not quite unit,
    and where both graze their dot product would magnify that to 5e-3.
    """
    both = wi.astype(float) + wo
    wi_h = np.linalg.norm(both, axis=1) / 2
    return both / (2 * wi_h[:, None]), wi_h


def D_ggx(h: np.ndarray, alpha: Alpha) -> np.ndarray:
    """Walter et al. 2007, eq. 33, (n,)."""
    h, a2 = h.astype(float), np.square(alpha)
    tan2 = (h[:, 0] ** 2 + h[:, 1] ** 2) / h[:, 2] ** 2
    return np.where(h[:, 2] > 0, 1 / (np.pi * a2 * h[:, 2] ** 4 * (1 + tan2 / a2) ** 2), 0)


def D_beckmann(h: np.ndarray, alpha: Alpha) -> np.ndarray:
    """Walter et al. 2007, eq. 25, (n,)."""
    h, a2 = h.astype(float), np.square(alpha)
    tan2 = (h[:, 0] ** 2 + h[:, 1] ** 2) / h[:, 2] ** 2
    return np.where(h[:, 2] > 0, np.exp(-tan2 / a2) / (np.pi * a2 * h[:, 2] ** 4), 0)


def D_mixture(h: np.ndarray, alpha: Alpha, weight: tuple[float, float]) -> np.ndarray:
    """The paper's eq. 8, (n,); weights of GGX and Beckmann."""
    return weight[0] * D_ggx(h, alpha) + weight[1] * D_beckmann(h, alpha)


def lambda_ggx(tangent: np.ndarray, alpha: Alpha) -> np.ndarray:
    """Heitz 2014, eq. 72, (n,), by tan(theta)."""
    return (np.sqrt(1 + (alpha * tangent.astype(float)) ** 2) - 1) / 2


def lambda_beckmann(tangent: np.ndarray, alpha: Alpha) -> np.ndarray:
    """Heitz 2014, eq. 68, (n,), by tan(theta); 1 / G1 = 1 + Lambda, so it may cancel below 1."""
    a = 1 / np.maximum(alpha * tangent.astype(float), 1e-100)
    return (erf(a) - 1) / 2 + np.exp(-(a**2)) / (2 * a * np.sqrt(np.pi))


def G1_smith(w: np.ndarray, alpha: Alpha, weight: tuple[float, float] = (1, 0)) -> np.ndarray:
    """Smith's masking of a mixture, (n,). Heitz 2014, eq. 14, is linear in D, and so is Lambda."""
    tangent = np.hypot(w[:, 0], w[:, 1], dtype=float) / w[:, 2]
    lobes = weight[0] * lambda_ggx(tangent, alpha) + weight[1] * lambda_beckmann(tangent, alpha)
    return 1 / (1 + lobes)


def G_vcavity(wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
    """Cook and Torrance 1982, eq. 5, (n,)."""
    h, wi_h = half_vector(wi, wo)
    return np.minimum(1, 2 * h[:, 2] * np.minimum(wi[:, 2], wo[:, 2]) / wi_h)


def G_mixture(
    wi: np.ndarray, wo: np.ndarray, alpha: Alpha, weight: tuple[float, float], masking: str
) -> np.ndarray:
    """The paper's eq. 9, or with `smith` Smith's own rule for a mixture, (n,)."""
    if masking == "smith":
        return G1_smith(wi, alpha, weight) * G1_smith(wo, alpha, weight)
    return weight[0] * G1_smith(wi, alpha) * G1_smith(wo, alpha) + weight[1] * G_vcavity(wi, wo)


def F_schlick(f0: np.ndarray | float, cosine: np.ndarray) -> np.ndarray:
    """Schlick 1994, eq. 15, for f0 (..., 3), (n, 3)."""
    return f0 + (1 - np.asarray(f0, float)) * (np.clip(1 - cosine, 0, 1) ** 5)[:, None]


def brdf(
    wi: np.ndarray,
    wo: np.ndarray,
    albedo: np.ndarray,
    f0: np.ndarray,
    alpha: Alpha,
    weight: tuple[float, float],
    weight_g: tuple[float, float],
    masking: str = "paper",
) -> np.ndarray:
    """f without the cosine, (n, 3): Cook and Torrance 1982 with kd = 1 - F(h.wi).

    Args:
        albedo: of the diffuse lobe, (..., 3).
        weight, weight_g: shares of GGX and Beckmann in D and in G.
    """
    h, wi_h = half_vector(wi, wo)
    with np.errstate(divide="ignore", invalid="ignore"):
        D, G = D_mixture(h, alpha, weight), G_mixture(wi, wo, alpha, weight_g, masking)
        specular = D * G / (4 * wi[:, 2].astype(float) * wo[:, 2])
    F = F_schlick(f0, wi_h)
    f = (1 - F) * albedo / np.pi + F * specular[:, None]
    return np.where((wi[:, 2:] > 0) & (wo[:, 2:] > 0), f, 0)


def oracle(
    material: Material, wi: np.ndarray, wo: np.ndarray, masking: str = "paper"
) -> np.ndarray:
    """f of a material without the cosine, (n, 3)."""
    return brdf(
        wi,
        wo,
        np.array(material.diffuse_albedo),
        np.array(material.specular_f0),
        material.alpha,
        (material.weight, 1 - material.weight),
        (material.masking_weight, 1 - material.masking_weight),
        masking,
    )


def density(h: np.ndarray, wo_h: np.ndarray, D: np.ndarray) -> np.ndarray:
    """Of wi mirrored about a facet drawn by D n.h, per steradian. Walter et al. 2007, eq. 14."""
    return D * h[:, 2] / (4 * wo_h)


def Lambda(w: np.ndarray, alpha: float, share: float) -> np.ndarray:
    """Smith's Lambda of GGX (by its share) and Beckmann mixed, (n,); 1 / G1 = 1 + Lambda."""
    tangent = np.hypot(w[:, 0], w[:, 1], dtype=float) / w[:, 2]
    return share * lambda_ggx(tangent, alpha) + (1 - share) * lambda_beckmann(tangent, alpha)
