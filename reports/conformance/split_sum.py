"""The split sum and its table."""

from collections.abc import Callable
from functools import cache

import numpy as np

from reports.stability import oracle
from scenes.schema import Material

Masking = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def scale_bias(
    cosine: float, alpha: float, weight: tuple[float, float], masking: Masking, points: int = 64
) -> np.ndarray:
    """The split sum's scale and bias for F0, (2,): Karis 2013, second sum, as an integral.

    Args:
        cosine: n.v.
        weight: shares of GGX and Beckmann in D.
        masking: G by wi, wo (n, 3) and wo.h (n,).
    """

    def split(_wi: np.ndarray, wo_h: np.ndarray) -> np.ndarray:
        fresnel = (1 - wo_h) ** 5
        return np.stack([1 - fresnel, fresnel])

    return _reflected(cosine, alpha, weight, masking, points, split)


def towards(
    cosine: float, alpha: float, weight: tuple[float, float], masking: Masking, points: int = 64
) -> np.ndarray:
    """The integral of wi itself, (2,): x and z of where light goes in the plane of incidence.

    The arguments are those of `scale_bias`.
    """
    return _reflected(cosine, alpha, weight, masking, points, lambda wi, _: wi[:, [0, 2]].T)


def _reflected(
    cosine: float,
    alpha: float,
    weight: tuple[float, float],
    masking: Masking,
    points: int,
    values: Callable[[np.ndarray, np.ndarray], np.ndarray],
) -> np.ndarray:
    """Integrals of values of wi and wo.h, (k, n), over what is reflected, (k,).

    Gauss-Legendre in the share of facets that lie nearer to n, uniform in azimuth; each lobe by its
    own facets.
    """
    nodes, areas = _gauss_legendre(points)
    share, area = np.repeat((nodes + 1) / 2, points), np.repeat(areas / 2, points) / points
    phi = np.tile(2 * np.pi * (np.arange(points) + 0.5) / points, points)
    wo = np.broadcast_to([np.sqrt(1 - cosine**2), 0.0, cosine], (len(phi), 3))
    total = np.zeros(2)
    for part, lobe in zip(weight, ("ggx", "beckmann"), strict=True):
        if not part:
            continue
        tan2 = alpha**2 * (share / (1 - share) if lobe == "ggx" else -np.log1p(-share))
        z = 1 / np.sqrt(1 + tan2)
        s = z * np.sqrt(tan2)
        h = np.stack([s * np.cos(phi), s * np.sin(phi), z], 1)
        wo_h = (wo * h).sum(axis=1)
        wi = 2 * wo_h[:, None] * h - wo
        seen = (wi[:, 2] > 0) & (wo_h > 0)
        wi, h, wo_h, a = wi[seen], h[seen], wo_h[seen], area[seen]
        value = masking(wi, wo[seen], wo_h) * wo_h / (h[:, 2] * cosine) * a
        total += part * values(wi, wo_h) @ value
    return total


@cache
def _gauss_legendre(points: int) -> tuple[np.ndarray, np.ndarray]:
    return np.polynomial.legendre.leggauss(points)


def smith(alpha: float, weight: tuple[float, float] = (1, 0)) -> Callable:
    """Separable Smith masking of a mixture, as `scale_bias` takes it."""
    return lambda wi, wo, wo_h: (
        oracle.G1_smith(wi, alpha, weight) * oracle.G1_smith(wo, alpha, weight)
    )


def vcavity(wi: np.ndarray, wo: np.ndarray, _wo_h: np.ndarray) -> np.ndarray:
    """V-cavities, as `scale_bias` takes them."""
    return oracle.G_vcavity(wi, wo)


def split_sum(
    material: Material, cosine: np.ndarray, L: np.ndarray, ab: np.ndarray, E: np.ndarray
) -> np.ndarray:
    """The paper's eq. 6 and 7, (n, 3).

    Args:
        cosine: n.v, (n,).
        L: prefiltered radiance (n, 3).
        ab: scale and bias, (n, 2).
        E: irradiance (n, 3).
    """
    f0, albedo = np.array(material.specular_f0), np.array(material.diffuse_albedo)
    kd = 1 - oracle.F_schlick(f0, cosine)
    return L * (f0 * ab[:, :1] + ab[:, 1:]) + kd * albedo / np.pi * E
