"""F of every model in double precision, in textbook form."""

from collections.abc import Callable

import numpy as np

from reports.stability.oracle import F_schlick
from scenes.schema import Material, Model

Fresnel = Callable[[np.ndarray], np.ndarray]


def F_f82(f0: np.ndarray, f82: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """Schlick's less what makes F f82 where the cosine is 1/7, at least 0, (n, 3).

    Kutz et al. 2021, after Lazanyi and Szirmay-Kalos 2005.
    """
    c, at = np.clip(cosine, 0, 1), np.array([1 / 7])
    slope = (F_schlick(f0, at) - f82) / (at * (1 - at) ** 6)
    return np.maximum(F_schlick(f0, cosine) - slope * (c * (1 - c) ** 6)[:, None], 0)


def F_exact(eta: np.ndarray | float, k: np.ndarray | float, cosine: np.ndarray) -> np.ndarray:
    """The Fresnel equations by complex amplitudes, (n, 3) or (n, 1). Born and Wolf 1999, 14.2.

    c - w = -(n² - 1) / (c + w) keeps what would cancel where n is near 1.
    """
    eta, k = (np.atleast_1d(np.asarray(x, float)) for x in (eta, k))
    c = np.clip(cosine.astype(float), 0, 1)[:, None]
    rest = (eta - 1) * (eta + 1) - k**2 + 2j * eta * k
    inside, s2 = np.sqrt(c**2 + rest + 0j), 1 - c**2
    total = np.where(c + inside == 0, 1, c + inside)
    s = -rest / total**2
    p = s * (inside * c - s2) / np.where(inside * c + s2 == 0, 1, inside * c + s2)
    return (np.abs(s) ** 2 + np.abs(p) ** 2) / 2


def fresnel_of(material: Material, model: Model) -> Fresnel:
    """F (n, 3) by cosines (n,) of a material under a model."""
    f0 = np.array(material.specular_f0)
    if model.fresnel == "schlick":
        return lambda c: F_schlick(f0, c)
    if model.fresnel == "f82":
        return lambda c: F_f82(f0, np.array(material.specular_f82), c)
    parts = []
    if material.metallic > 0:
        parts.append((material.metallic, *map(np.array, material.metal_index)))
    if material.metallic < 1:
        parts.append((1 - material.metallic, material.one_eta, 0.0))
    return lambda c: np.zeros((len(c), 3)) + sum(share * F_exact(*n, c) for share, *n in parts)
