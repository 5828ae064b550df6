"""The model written down a second time, in float64 and textbook form, for the tests to compare."""

import numpy as np
from scipy.special import erfc


def brdf(wi, wo, albedo, f0, alpha, weight, weight_g, masking="paper"):
    """f (n, 3), without the cosine, for unit vectors (n, 3) above the surface."""
    h = wi + wo
    h /= np.linalg.norm(h, axis=1, keepdims=True)
    zi, zo, zh = wi[:, 2], wo[:, 2], h[:, 2]
    io = np.sum(wi * h, axis=1)
    D = weight * ggx(h, alpha) + (1 - weight) * beckmann(h, alpha)
    if masking == "smith":
        G = mixed_g1(zi, alpha, weight_g) * mixed_g1(zo, alpha, weight_g)
    else:
        cavity = np.minimum(1, np.minimum(2 * zh * zi / io, 2 * zh * zo / io))
        G = weight_g * g1(zi, alpha) * g1(zo, alpha) + (1 - weight_g) * cavity
    F = np.asarray(f0) + (1 - np.asarray(f0)) * ((1 - io) ** 5)[:, None]
    return (1 - F) * np.asarray(albedo) / np.pi + F * (D * G / (4 * zi * zo))[:, None]


def ggx(h, alpha):
    """Walter et al. 2007, eq. 33."""
    tan2 = np.sum(h[:, :2] ** 2, axis=1) / h[:, 2] ** 2
    return alpha**2 / (np.pi * h[:, 2] ** 4 * (alpha**2 + tan2) ** 2)


def beckmann(h, alpha):
    """Walter et al. 2007, eq. 25."""
    tan2 = np.sum(h[:, :2] ** 2, axis=1) / h[:, 2] ** 2
    return np.exp(-tan2 / alpha**2) / (np.pi * alpha**2 * h[:, 2] ** 4)


def g1(cosine, alpha):
    """Smith masking of GGX; Walter et al. 2007, eq. 34."""
    return 2 / (1 + np.sqrt(1 + alpha**2 * (1 - cosine**2) / cosine**2))


def g1_beckmann(cosine, alpha):
    """Smith masking of Beckmann; Walter et al. 2007, eq. 26, with erf = 1 - erfc."""
    a = cosine / (alpha * np.sqrt(1 - cosine**2))
    return 2 / (2 - erfc(a) + np.exp(-(a**2)) / (a * np.sqrt(np.pi)))


def mixed_g1(cosine, alpha, weight_g):
    """The harmonic mean of the two."""
    return 1 / (weight_g / g1(cosine, alpha) + (1 - weight_g) / g1_beckmann(cosine, alpha))


def fresnel(cosine, eta, k):
    """Unpolarised reflectance of a smooth interface from vacuum, by complex amplitudes, (n, 3)."""
    n, cosine = np.asarray(eta) + 1j * np.asarray(k), np.asarray(cosine)[:, None]
    inside = np.sqrt(1 - (1 - cosine**2) / n**2)
    s = (cosine - n * inside) / (cosine + n * inside)
    p = (n * cosine - inside) / (n * cosine + inside)
    return (np.abs(s) ** 2 + np.abs(p) ** 2) / 2


def directional_albedo(cosine, *parameters, steps=400):
    """Share (3,) of uniform light reflected to an eye at this cosine, by a grid over light."""
    theta = (np.arange(steps) + 0.5) / steps * np.pi / 2
    phi = (np.arange(steps) + 0.5) / steps * np.pi
    theta, phi = (a.ravel() for a in np.meshgrid(theta, phi))
    wi = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], 1)
    wo = np.broadcast_to([np.sqrt(1 - cosine**2), 0, cosine], wi.shape)
    area = np.sin(theta) * np.cos(theta) * (np.pi / 2 / steps) * (2 * np.pi / steps)
    return np.sum(brdf(wi, wo, *parameters) * area[:, None], axis=0)
