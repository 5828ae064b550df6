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


def Lambda(w: np.ndarray, alpha: float, share: float) -> np.ndarray:
    """Smith's Lambda of GGX (by its share) and Beckmann mixed, (n,); 1 / G1 = 1 + Lambda."""
    tangent = np.hypot(w[:, 0], w[:, 1], dtype=float) / w[:, 2]
    return share * lambda_ggx(tangent, alpha) + (1 - share) * lambda_beckmann(tangent, alpha)


def beckmann_over_ggx(h: np.ndarray, alpha: Alpha) -> np.ndarray:
    """D_beckmann / D_ggx, (n,); 0 at the horizon."""
    with np.errstate(divide="ignore"):
        t = (h[:, 0].astype(float) ** 2 + h[:, 1].astype(float) ** 2) / (alpha * h[:, 2]) ** 2
    return np.exp(-t) * np.square(1 + np.minimum(t, 1e100))


def sampled_ggx(u: np.ndarray, alpha: Alpha) -> np.ndarray:
    """A half vector, (n, 3). Walter et al. 2007, eq. 35 and 36."""
    return _polar(alpha * np.sqrt(u[:, 0] / (1 - u[:, 0].astype(float))), u[:, 1])


def sampled_beckmann(u: np.ndarray, alpha: Alpha) -> np.ndarray:
    """A half vector, (n, 3). Walter et al. 2007, eq. 28 and 29."""
    return _polar(alpha * np.sqrt(-np.log1p(-u[:, 0].astype(float))), u[:, 1])


def sampled_cosine(u: np.ndarray) -> np.ndarray:
    """A direction, (n, 3), by Malley's method; Pharr et al. 2016, 13.6.3."""
    return _polar(np.sqrt(u[:, 0] / (1 - u[:, 0].astype(float))), u[:, 1])


def _polar(tangent: np.ndarray, turn: np.ndarray) -> np.ndarray:
    cosine, phi = 1 / np.sqrt(1 + tangent**2), 2 * np.pi * turn.astype(float)
    slopes = [tangent * np.cos(phi), tangent * np.sin(phi), 1 + 0 * phi]
    return np.stack(slopes, axis=1) * cosine[:, None]


def sample_density(wi: np.ndarray, wo: np.ndarray, alpha: Alpha, count: np.ndarray) -> np.ndarray:
    """Of `count` (..., 3) samples of GGX, Beckmann and cosine together, per steradian, (n,)."""
    h, wo_h = half_vector(wi, wo)
    share = np.moveaxis(np.asarray(count, float), -1, 0)
    facets = share[0] * D_ggx(h, alpha) + share[1] * D_beckmann(h, alpha)
    # Walter et al. 2007, eq. 14
    return facets * h[:, 2] / (4 * wo_h) + share[2] * wi[:, 2].astype(float) / np.pi


def _stretched(w: np.ndarray, alpha: Alpha) -> np.ndarray:
    out = w.astype(float) * np.stack([np.asarray(alpha) + 0 * w[:, 0]] * 2 + [1 + 0 * w[:, 0]], 1)
    return out / np.linalg.norm(out, axis=1, keepdims=True)


def sampled_visible_ggx(u: np.ndarray, wo: np.ndarray, alpha: Alpha) -> np.ndarray:
    """A half vector, (n, 3): Dupuy and Benyoub 2023, listing 3, with more samples in the tail."""
    r = np.maximum(1 - u[:, 0].astype(float), 2.0**-24)
    beyond = r * (alpha + (1 - alpha) * r)
    s, phi = _stretched(wo, alpha), 2 * np.pi * u[:, 1].astype(float)
    height = (1 + s[:, 2]) * beyond  # of h: z + s.z
    aside = np.sqrt(np.maximum((1 + s[:, 2] - height) * (1 - s[:, 2] + height), 0))
    h = np.stack([aside * np.cos(phi) + s[:, 0], aside * np.sin(phi) + s[:, 1], height], 1)
    return _stretched(h, alpha)


def pdf_visible_ggx(wi: np.ndarray, wo: np.ndarray, alpha: Alpha) -> np.ndarray:
    """Density of the directions wi that those reflect, per steradian, (n,).

    Heitz 2018, eq. 3 and 17: G1(wo) D(h) / (4 n.wo); and dr/dq where q = alpha r + (1 - alpha) r².
    """
    h, _ = half_vector(wi, wo)
    s, k = _stretched(wo, alpha), _stretched(h, 1 / np.asarray(alpha))
    q = 2 * np.maximum((s * k).sum(axis=1), 0) * np.maximum(k[:, 2], 0) / (1 + s[:, 2])
    tail = 1 / np.sqrt(np.square(alpha) + 4 * (1 - np.asarray(alpha)) * q)
    return tail * D_ggx(h, alpha) * G1_smith(wo, alpha) / (4 * wo[:, 2].astype(float))


def filtered_density(wi: np.ndarray, wo: np.ndarray, alpha: Alpha, count: np.ndarray) -> np.ndarray:
    """Of `count` (..., 2 or more) samples of visible normals and of cosine, per steradian, (n,)."""
    share = np.moveaxis(np.asarray(count, float), -1, 0)
    return share[0] * pdf_visible_ggx(wi, wo, alpha) + share[1] * wi[:, 2].astype(float) / np.pi


def spiral(index: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Point i of n of a spiral of golden angles (Vogel 1979), (n, 2): ring and turn."""
    golden = (np.sqrt(5) - 1) / 2
    turn = (golden * index.astype(float) + 0.25) % 1
    return np.stack([(index.astype(float) + 0.5) / points, turn], axis=1)


def view_axis(n: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The axis across n in the plane of n and v, (n, 3), towards v."""
    n, v = n.astype(float), v.astype(float)
    x = v - (n * v).sum(axis=1, keepdims=True) * n
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def tangent(n: np.ndarray) -> np.ndarray:
    """The first axis of a frame about n, (n, 3). Duff et al. 2017, listing 3."""
    x, y, z = n.astype(float).T
    s = np.where(z >= 0, 1.0, -1.0)
    return np.stack([1 - s * x * x / (s + z), -s * x * y / (s + z), -s * x], axis=1)


def latlong(w: np.ndarray) -> np.ndarray:
    """u and v of a direction, (n, 2): azimuth atan2(x, y) / 2 pi, polar angle / pi."""
    x, y, z = w.astype(float).T
    return np.stack([np.arctan2(x, y) / (2 * np.pi), np.arctan2(np.hypot(x, y), z) / np.pi], 1)


def hammersley(index: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Point i of n, (n, 2): (i + .5) / n, and i's binary digits mirrored at the point."""
    i, mirrored = index.astype(np.uint64), np.zeros(len(index))
    for bit in range(32):
        mirrored += ((i >> np.uint64(bit)) & np.uint64(1)) * 0.5 ** (bit + 1)
    return np.stack([(index.astype(float) + 0.5) / points, mirrored], axis=1)


def mip_level(
    size: tuple[int, int], world: np.ndarray, solid_angle: np.ndarray | float
) -> np.ndarray:
    """The level of a lat-long map (width, height) whose texels are as large as a solid angle, (n,).

    Colbert and Krivanek 2007, eq. 13; nearer to a pole than half a row sin(theta) stays.

    Args:
        world: (n, 3).
    """
    width, height = size
    sine = np.maximum(np.hypot(world[:, 0], world[:, 1]), 0.5 / height)
    texel = 2 * np.pi**2 / (width * max(height - 1, 1)) * sine
    return np.maximum(0.5 * np.log2(np.minimum(solid_angle / texel, 1e30)), 0)
