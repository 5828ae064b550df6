"""What a case's specular lobe sends back of even light, by quadrature in double precision.

Facets of one NDF are integrated over in polar form about n, in the variable in which the share of
facets is smooth. Seen from wo at theta_o, with cot x = tan theta_o cos phi, a facet tilted by
theta_h faces wo below x and mirrors it above the surface below x / 2. Cavities mask or shadow it
from x / 3 on (from pi - x where x > 3 pi / 4), and n.wi falls below n.wo at x - pi / 2; panels end
there, and where tan theta_o cos phi is 0 or 1, which at grazing angles is a step.
"""

from collections.abc import Callable

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import erf

NODES = 24  # Gauss-Legendre, per panel and dimension
CAVITY_NODES = 64  # where cavities mask, with kinks across panels when wo grazes
PLACES = np.linspace(0, 1, 97)  # see `place`
TEXELS = 1024  # read linearly; what a cubic spline makes of the places
BECKMANN_END = 6.5  # slopes over alpha; what lies beyond weighs exp(-42)
Fresnel = Callable[[np.ndarray], np.ndarray]


def lost_light(
    alpha: float,
    weight: float,
    weight_g: float,
    masking: str,
    fresnel: Fresnel,
    multiscatter: bool,
) -> tuple[np.ndarray, np.ndarray, float]:
    """The factors of light that the specular lobe does not send back.

    With E(w) its albedo, which counts light off more facets than one where there is
    `multiscatter`, a loss 1 - E is divided by the root of its mean over a hemisphere, so that
    factor(wi) factor(wo) / pi sends back just what is lost: Kelemen and Szirmay-Kalos 2001, eq. 4,
    for the diffuse lobe, and Kulla and Conty 2017 for facets with F = 1.

    Args:
        alpha: microfacet width; the other shares and names are those of the plugin `mixture`.
        fresnel: F (..., 3) by cosines (...).

    Returns:
        The factors (TEXELS, 4) over the `place` of n.w, rgb for the diffuse lobe and a for facets;
        F_ms (3,), the share of lost light that more facets than one send back (0 without); and
        the root of the mean loss with F = 1.
    """
    cosines = np.maximum(PLACES**4 * (2 - PLACES**4), 1e-6)
    E = np.stack([_albedo(c, alpha, weight, weight_g, masking, fresnel) for c in cosines])
    single, white = E[:, :3], E[:, 3:]
    back = np.zeros(3)
    if multiscatter:
        F, E_mean = _mean(fresnel(cosines)), _mean(white)
        # Squared: two facets or more reflect it. Hill 2018, "A Multi-Faceted Exploration", part 2.
        back = F**2 * E_mean / (1 - F * (1 - E_mean))
    factors = np.concatenate(
        [_over_root(1 - single - back * (1 - white)), _over_root(1 - white)], 1
    )
    return factors, back, float(np.sqrt(np.maximum(_mean(1 - white), 0))[0])


def place(cosine):
    """Where a cosine stands from 0 to 1: x, for a cosine of y (2 - y) with y = x^4.

    Narrow lobes lose light only at cosines about alpha; near n wide ones do by the third power of
    the angle, which is no polynomial of the cosine. Takes arrays of NumPy and of Dr.Jit.
    """
    return (cosine / (1 + (1 - cosine) ** 0.5)) ** 0.25


def _mean(values: np.ndarray) -> np.ndarray:
    """2 ∫ v mu dmu of values (n, k) at the places."""
    x, y = PLACES[:, None], PLACES[:, None] ** 4
    return CubicSpline(PLACES, values * 16 * (2 - y) * (1 - y) * x**7).integrate(0, 1)


def _over_root(loss: np.ndarray) -> np.ndarray:
    mean = _mean(loss)
    fine = CubicSpline(PLACES, loss)(np.linspace(0, 1, TEXELS))
    # Where all comes back the quadrature leaves 1e-7 of either sign.
    return np.maximum(fine, 0) / np.sqrt(np.where(mean > 0, mean, np.inf))


def _albedo(
    cosine: float, alpha: float, weight: float, weight_g: float, masking: str, fresnel: Fresnel
) -> np.ndarray:
    """E(wo) per channel and with F = 1, (4,)."""
    total, theta = np.zeros(4), np.arccos(min(cosine, 1 - 1e-12))
    for ndf, share in (("ggx", weight), ("beckmann", 1 - weight)):
        if not share:
            continue
        nodes = NODES if masking == "smith" or weight_g == 1 else CAVITY_NODES
        measure, n_h, wo_h, n_wi = _facets(ndf, alpha, theta, nodes)
        if masking == "smith":
            G = _smith(n_wi, alpha, weight_g) * _smith(cosine, alpha, weight_g)
        else:
            ggx = _smith(n_wi, alpha, 1) * _smith(cosine, alpha, 1)
            cavity = np.minimum(1, 2 * n_h * np.minimum(n_wi, cosine) / wo_h)
            G = weight_g * ggx + (1 - weight_g) * cavity
        # f n.wi dwi = F D G / (4 n.wo) 4 wo.h dh
        lit = share * measure * G * wo_h / (n_h * cosine)
        total += lit @ np.column_stack([fresnel(wo_h), np.ones(len(wo_h))])
    return total


def _facets(ndf: str, alpha: float, theta: float, nodes: int) -> tuple[np.ndarray, ...]:
    """Facets that mirror wo above the surface: D n.h dh, n.h, wo.h and n.wi, (n,) each."""
    slope_o = np.tan(theta)
    turns = np.arccos(np.clip(np.array([1, 0, -1]) / max(slope_o, 1), -1, 1))
    phi, d_phi = _panels(np.array([0, *turns, np.pi]), nodes)
    x = np.arctan2(1, slope_o * np.cos(phi))
    steep = x > 0.75 * np.pi
    kinks = [
        np.where(steep, np.pi - x, x / 3),
        np.where(steep, x - np.pi / 2, x / 3),
        np.minimum(np.pi / 4, x / 2),  # no kink, but where wo grazes G1 of GGX turns
        x / 2,
    ]
    slopes = np.tan(np.sort(np.stack([0 * x, *kinks], axis=1), axis=1)) / alpha
    if ndf == "ggx":  # D n.h dh is d(sin²(s)) dphi / 2 pi for a slope of alpha tan(s)
        s, ds = _panels(np.arctan(slopes), nodes)
        slope, share = alpha * np.tan(s), ds * np.sin(2 * s)
    else:  # and -d(exp(-s²)) for one of alpha s
        s, ds = _panels(np.minimum(slopes, BECKMANN_END), nodes)
        slope, share = alpha * s, ds * 2 * s * np.exp(-(s**2))
    n_h = 1 / np.sqrt(1 + slope**2)
    n_wo = np.cos(theta)
    wo_h = np.maximum(n_wo * n_h * (1 - slope * slope_o * np.cos(phi)[:, None]), 1e-300)
    n_wi = np.maximum(2 * wo_h * n_h - n_wo, 0)
    measure = share * d_phi[:, None] / np.pi  # phi from 0 to pi stands for both sides
    return measure.ravel(), n_h.ravel(), wo_h.ravel(), n_wi.ravel()


def _smith(cosine: np.ndarray | float, alpha: float, share: float) -> np.ndarray:
    """G1 of GGX by its share with Beckmann; Heitz 2014, eq. 68 and 72, whose Lambda add up."""
    slope = alpha * np.sqrt(1 - np.minimum(np.square(cosine), 1))  # times the cosine
    ggx = (cosine + np.sqrt(np.square(cosine) + slope**2)) / 2
    a = cosine / np.maximum(slope, 1e-12)
    beckmann = cosine * (1 + erf(a)) / 2 + slope * np.exp(-(a**2)) / (2 * np.sqrt(np.pi))
    return cosine / np.maximum(share * ggx + (1 - share) * beckmann, 1e-300)


def _panels(ends: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre nodes and weights (..., panels x count) between ends (..., panels + 1)."""
    x, w = np.polynomial.legendre.leggauss(count)
    start, width = ends[..., :-1, None], np.diff(ends)[..., None]
    shape = (*ends.shape[:-1], -1)
    nodes = start + width * (x + 1) / 2
    return nodes.reshape(shape), (width * w / 2).reshape(shape)


def schlick(f0: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """Schlick 1994, eq. 15, (..., 3)."""
    return f0 + (1 - f0) * np.clip(1 - cosine[..., None], 0, 1) ** 5


def f82(f0: np.ndarray, at_82: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """Kutz et al. 2021 after Lazanyi and Szirmay-Kalos 2005, (..., 3); see `mixture`."""
    c, at = cosine[..., None], np.array([1 / 7])
    drop = (schlick(f0, at) - at_82) / (at * (1 - at) ** 6)
    return np.maximum(schlick(f0, cosine) - drop * c * (1 - c) ** 6, 0)


def exact(eta: np.ndarray, k: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """The Fresnel equations by complex amplitudes, (..., 3). Born and Wolf 1999, section 14.2."""
    n2, c = (eta + 1j * k) ** 2, np.clip(cosine, 1e-12, 1)[..., None]
    inside = np.sqrt(n2 - (1 - c**2))
    s, p = (c - inside) / (c + inside), (n2 * c - inside) / (n2 * c + inside)
    return (np.abs(s) ** 2 + np.abs(p) ** 2) / 2
