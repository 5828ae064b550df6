"""The model in double precision: what the shaders and Mitsuba are held against."""

import numpy as np
from scipy.special import erf

from scenes.schema import Material


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
