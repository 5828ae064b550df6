"""The BRDF of every model in double precision, with integrals by quadrature over facets."""

from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline

from reports.stability.fresnel import Fresnel, fresnel_of
from reports.stability.oracle import (
    D_beckmann,
    D_ggx,
    D_mixture,
    G1_smith,
    G_mixture,
    half_vector,
)
from reports.stability.quadrature import facets
from scenes.schema import Material, Model

PLACES = np.linspace(0, 1, 97)  # x, for cosines y (2 - y) with y = x^4
COSINES = np.maximum(PLACES**4 * (2 - PLACES**4), 1e-6)


def model_brdf(material: Material, wi: np.ndarray, wo: np.ndarray, model: Model) -> np.ndarray:
    """f of a material under a model without the cosine, (n, 3), for directions (n, 3)."""
    h, wi_h = half_vector(wi, wo)
    alpha, weight, weight_g = _shape(material)
    with np.errstate(divide="ignore", invalid="ignore"):
        D, G = D_mixture(h, alpha, weight), G_mixture(wi, wo, alpha, weight_g, model.masking)
        facet = D * G / (4 * wi[:, 2].astype(float) * wo[:, 2])
    F = fresnel_of(material, model)(wi_h)
    f = F * facet[:, None]
    albedo = np.array(material.diffuse_albedo)
    if model.multiscatter == "on" or (model.kd == "conserving" and albedo.any()):
        diffuse, white, back = _losses(material.model_copy(update=NAMELESS), model)
        if model.multiscatter == "on":
            f += back * (white(wi) * white(wo))[:, None] / np.pi
    if albedo.any():
        if model.kd == "one-minus-fresnel":
            f += (1 - F) * albedo / np.pi
        elif model.kd == "conserving":
            f += diffuse(wi) * diffuse(wo) * albedo / np.pi
        else:
            through = _passed(material.one_eta, alpha)
            both = through(wi) * through(wo)
            f += (both @ np.array(weight))[:, None] * albedo / np.pi
    return np.where((wi[:, 2:] > 0) & (wo[:, 2:] > 0), f, 0)


NAMELESS = {"name": "", "description": "", "source": ""}  # surfaces are told apart by what they do


def specular_albedo(
    material: Material, cosine: float, model: Model, fresnel: Fresnel
) -> np.ndarray:
    """Even light that the specular lobe sends back to a cosine off one facet, per channel, (3,)."""
    alpha, weight, weight_g = _shape(material)
    seen = facets(alpha, cosine)
    wi = 2 * seen.wo_h[:, None] * seen.h - seen.wo
    lit = (seen.wo_h > 0) & (wi[:, 2] > 0)
    h, wi, wo_h, omega = seen.h[lit], wi[lit], seen.wo_h[lit], seen.omega[lit]
    wo = np.broadcast_to(seen.wo, wi.shape)
    D, G = D_mixture(h, alpha, weight), G_mixture(wi, wo, alpha, weight_g, model.masking)
    # f n.wi dwi, and dwi = 4 wo.h dh
    return (D * G * wo_h / cosine * omega) @ fresnel(wo_h)


def transmitted(eta: float, alpha: float, cosine: float) -> np.ndarray:
    """Light from a cosine that passes a rough interface, of GGX and of Beckmann, (2,).

    Walter et al. 2007, eq. 21, over the half space below, each with its own Smith masking.
    """
    seen = facets(alpha, cosine)
    facing = seen.wo_h > 0
    h, wo_h, omega = seen.h[facing], seen.wo_h[facing], seen.omega[facing]
    cos_t = np.sqrt(1 - (1 - wo_h**2) / eta**2)
    down = (wo_h / eta - cos_t)[:, None] * h - seen.wo / eta
    below = down[:, 2] < 0
    h, wo_h, omega, up = h[below], wo_h[below], omega[below], -down[below]
    one = np.array([[*seen.wo]])
    F = fresnel_of(Material(albedo=(0, 0, 0), roughness=1, metallic=0, f0=_f0(eta)), EXACT)(wo_h)
    common = (1 - F[:, 0]) * wo_h / cosine * omega
    return np.array(
        [
            common @ (D(h, alpha) * G1_smith(up, alpha, lobe)) * G1_smith(one, alpha, lobe)[0]
            for D, lobe in ((D_ggx, (1, 0)), (D_beckmann, (0, 1)))
        ]
    )


EXACT = Model(fresnel="exact")


def _f0(eta: float) -> float:
    return ((eta - 1) / (eta + 1)) ** 2


def _shape(material: Material) -> tuple:
    share, share_g = material.weight, material.masking_weight
    return material.alpha, (share, 1 - share), (share_g, 1 - share_g)


@lru_cache(maxsize=64)
def _losses(material: Material, model: Model) -> tuple:
    """What `conserving` and `multiscatter` make of losses: functions of directions, and F_ms."""
    F = fresnel_of(material, model)

    def both(c: np.ndarray) -> np.ndarray:
        return np.column_stack([F(c), np.ones(len(c))])

    E = np.stack([specular_albedo(material, c, model, both) for c in COSINES])
    single, white, back = E[:, :3], E[:, 3:], np.zeros(3)
    if model.multiscatter == "on":
        F_mean, E_mean = _mean(F(COSINES)), _mean(white)
        back = F_mean**2 * E_mean / (1 - F_mean * (1 - E_mean))  # Hill 2018
    diffuse, facet = _over_root(1 - single - back * (1 - white)), _over_root(1 - white)
    return diffuse, lambda w: facet(w)[:, 0], back


@lru_cache(maxsize=64)
def _passed(eta: float, alpha: float):
    """Transmittance over its mean, by directions."""
    T = np.stack([transmitted(eta, alpha, c) for c in COSINES])
    spline, mean = CubicSpline(PLACES, T), _mean(T)
    return lambda w: spline(_place(w)) / mean


def _over_root(loss: np.ndarray):
    """A loss over the root of its mean, by directions."""
    spline, mean = CubicSpline(PLACES, loss), _mean(loss)
    root = np.sqrt(np.where(mean > 0, mean, np.inf))
    return lambda w: np.maximum(spline(_place(w)), 0) / root


def _mean(values: np.ndarray) -> np.ndarray:
    """2 ∫ v mu dmu."""
    x, y = PLACES[:, None], PLACES[:, None] ** 4
    return CubicSpline(PLACES, values * 16 * (2 - y) * (1 - y) * x**7).integrate(0, 1)


def _place(w: np.ndarray) -> np.ndarray:
    cosine = np.clip(w[:, 2].astype(float), 0, 1)
    return (cosine / (1 + np.sqrt(1 - cosine))) ** 0.25
