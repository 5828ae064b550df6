"""Does the paper's mixture keep energy? White furnaces, by quadrature in double precision.

The paper mixes D = sum w_i D_i and G = sum w_j G_j (eq. 8 and 9) and holds that weights which sum
to 1 keep energy. Two furnaces test that, for light that comes alike from everywhere:

- weak white furnace, W(wo) = ∫ D(h) G1(wo, h) <wo.h> / n.wo dh (Heitz 2014, eq. 80): what the
  facets that wo sees cover of the surface that it sees. 1 is right for every roughness and angle;
  less loses light, more makes it.
- furnace albedo, A(wo) = ∫ f n.wi dwi: what one reflection sends back. Here less than 1 is right,
  since light that meets a second facet is left out; more than 1 is not.

Maskings: `paper` is G = v G1_ggx(wi) G1_ggx(wo) + (1 - v) G_vcavity; `smith` is the exact one of a
mixture, 1 / G1 = w / G1_ggx + (1 - w) / G1_beckmann, because Smith's condition
n.wo = ∫ G1 <wo.h> D dh is linear in D; G = G1(wi) G1(wo).

Integrals run over the facets' slopes in polar form. The radius is a variable in which the NDF is
smooth, so that the nodes follow the lobe however narrow; panels end where the integrand has a
kink, and all of these have closed forms in x, cot x = tan(theta_o) cos(phi):

    wo.h > 0           up to theta_h = x             (x < π/2)
    n.wi > 0           up to theta_h = x / 2
    V-cavity open      up to theta_h = x / 3         (x < 3π/4; there light is shadowed first)
                       up to theta_h = π - x         (else; the eye is masked first)
    n.wi < n.wo        from theta_h = x - π/2
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Literal, get_args

import numpy as np
from scipy.special import erf

from reports.panels import panels

NODES = 24  # per panel and dimension; errors below 5e-6 for alpha in [.01, 1], angles to 89°
BECKMANN_END = 6.5  # slopes over alpha; what lies beyond weighs exp(-42)

Masking = Literal["paper", "smith"]
NDF = Literal["ggx", "beckmann"]


@dataclass(frozen=True)
class Surface:
    """Mixtures of GGX and Beckmann, one for each weight, of one masking.

    Attributes:
        alpha: microfacet widths of the GGX lobe and of the Beckmann lobe; the paper's are equal.
        weight: (k,) shares of GGX in D.
        masking: `paper` or `smith`.
        weight_g: (k,) shares of GGX's masking in G; None is `weight`. `smith` has no use for it.
    """

    alpha: tuple[float, float]
    weight: np.ndarray
    masking: Masking
    weight_g: np.ndarray | None = None

    @property
    def shares(self) -> tuple[tuple[NDF, float, np.ndarray], ...]:
        """NDF, width and weights (k,) of each lobe."""
        return (("ggx", self.alpha[0], self.weight), ("beckmann", self.alpha[1], 1 - self.weight))

    def G1_smith(self, cosine: np.ndarray | float) -> np.ndarray:
        """The mixture's exact Smith masking (k, ...) for cosines (...), 0 at cosine 0."""
        w = self.weight.reshape(-1, *[1] * np.ndim(cosine))
        area = w * projected_area_ggx(cosine, self.alpha[0])
        return cosine / (area + (1 - w) * projected_area_beckmann(cosine, self.alpha[1]))

    def mix(self, smith: np.ndarray, vcavity: np.ndarray) -> np.ndarray:
        """The paper's mixture (k, ...) of two maskings (...)."""
        v = self.weight if self.weight_g is None else self.weight_g
        v = v.reshape(-1, *[1] * np.ndim(vcavity))
        return v * smith + (1 - v) * vcavity


def projected_area_ggx(cosine: np.ndarray | float, alpha: float) -> np.ndarray:
    """n.w / G1(w), the area of the facets seen from w. Walter et al. 2007, eq. 34."""
    return (cosine + np.sqrt(cosine**2 + alpha**2 * (1 - cosine**2))) / 2


def projected_area_beckmann(cosine: np.ndarray | float, alpha: float) -> np.ndarray:
    """The same for Beckmann, n.w (1 + Lambda(w)). Heitz 2014, eq. 68."""
    sine = np.maximum(alpha * np.sqrt(1 - cosine**2), 1e-12)
    a = np.minimum(cosine / sine, 1e6)
    return cosine * (1 + erf(a)) / 2 + sine * np.exp(-(a**2)) / (2 * np.sqrt(np.pi))


@dataclass(frozen=True)
class Facets:
    """Facets of one NDF as one direction wo sees them, each (n,).

    Attributes:
        weight: share of D(h) n.h dh; all facets sum to 1.
        seen: wo.h / (n.wo n.h), at least 0.
        cos_i: n.wi of the mirrored direction.
        cos_d: wo.h.
    """

    weight: np.ndarray
    seen: np.ndarray
    cos_i: np.ndarray
    cos_d: np.ndarray


@lru_cache(maxsize=4)  # two lobes, lit or not: both maskings share them
def facets(ndf: NDF, alpha: float, theta: float, lit: bool, nodes: int = NODES) -> Facets:
    """Quadrature over facets that face wo, or if `lit` only those that mirror it above the surface.

    Args:
        theta: angle of wo from the normal, radians, in [0, π/2).
        nodes: Gauss-Legendre nodes per panel and dimension.
    """
    tan = np.tan(theta)
    # tan(theta_o) cos(phi) = ±1, 0: x crosses π/4, π/2 and 3π/4, quickly where wo grazes.
    turns = np.arccos([1 / tan, 0, -1 / tan]) if tan > 1 else [np.pi / 2]
    phi, d_phi = panels(np.array([0, *turns, np.pi]), nodes)
    x = np.arctan2(1, tan * np.cos(phi))
    masked = x > 0.75 * np.pi
    if lit:
        end = x / 2
        kinks = (
            np.where(masked, np.pi - x, x / 3),
            np.where(masked, x - np.pi / 2, x / 3),
            np.minimum(np.pi / 4, end),  # no kink, but G1 of GGX turns here where wo grazes
        )
    else:
        end = np.minimum(x, np.pi / 2)
        kinks = (np.minimum(np.pi - x, end),)
    ends = np.sort(np.stack([np.zeros_like(x), *kinks, end], axis=-1))
    with np.errstate(over="ignore"):
        slope = np.where(ends < np.pi / 2, np.tan(ends), np.inf) / alpha
    if ndf == "ggx":  # share of facets within r is sin²(psi), tan(psi) = r / alpha
        psi, d = panels(np.arctan(slope), nodes)
        r, d = alpha * np.tan(psi), d * np.sin(2 * psi)
    else:  # and 1 - exp(-rho²), rho = r / alpha
        rho, d = panels(np.minimum(slope, BECKMANN_END), nodes)
        r, d = alpha * rho, d * 2 * rho * np.exp(-(rho**2))
    seen = 1 - r * np.cos(phi)[:, None] * tan
    cosine, stretch = np.cos(theta), 1 + r**2
    return Facets(
        weight=(d * d_phi[:, None] / np.pi).ravel(),
        seen=np.maximum(seen, 0).ravel(),
        cos_i=np.maximum(cosine * (2 * seen / stretch - 1), 0).ravel(),
        cos_d=np.maximum(cosine * seen / np.sqrt(stretch), 0).ravel(),
    )


def weak_furnace(surface: Surface, theta: float, nodes: int = NODES) -> np.ndarray:
    """W(wo) of each mixture, (k,). Heitz 2014, eq. 80; the V-cavity's G1 is his eq. 62.

    Args:
        theta: angle of wo from the normal, radians, in [0, π/2).
    """
    cosine = np.cos(theta)
    exact = surface.G1_smith(cosine)
    total = np.zeros_like(surface.weight)
    for ndf, alpha, share in surface.shares:
        f = facets(ndf, alpha, theta, lit=False, nodes=nodes)
        covered = f.weight * f.seen
        if surface.masking == "smith":
            total += share * exact * covered.sum()
            continue
        smith = cosine / projected_area_ggx(cosine, surface.alpha[0])
        vcavity = np.minimum(1, 2 / np.maximum(f.seen, 1e-300))
        total += share * surface.mix(smith * covered.sum(), vcavity @ covered)
    return total


def furnace_albedo(
    surface: Surface, theta: float, f0: tuple[float, ...] = (1.0,), nodes: int = NODES
) -> np.ndarray:
    """A(wo) of the specular lobe alone, (f0, k), with Schlick's Fresnel; F0 = 1 is F = 1.

    Args:
        theta: angle of wo from the normal, radians, in [0, π/2).
        f0: reflectances at normal incidence.
    """
    cosine = np.cos(theta)
    total = np.zeros((len(f0), surface.weight.size))
    for ndf, alpha, share in surface.shares:
        f = facets(ndf, alpha, theta, lit=True, nodes=nodes)
        F = np.stack([schlick(reflectance, f.cos_d) for reflectance in f0])
        lit = (F * f.weight * f.seen).T
        if surface.masking == "smith":
            G = surface.G1_smith(f.cos_i) * surface.G1_smith(cosine)[:, None]
            total += share * (G @ lit).T
            continue
        smith = cosine / projected_area_ggx(cosine, surface.alpha[0])
        smith = smith * f.cos_i / projected_area_ggx(f.cos_i, surface.alpha[0])
        low = np.minimum(cosine, f.cos_i)
        vcavity = np.minimum(1, 2 * low / (cosine * f.seen))
        total += share * surface.mix(smith @ lit, vcavity @ lit).T
    return total


def diffuse_albedo(theta: float, f0: float, nodes: int = NODES) -> float:
    """A(wo) of a white diffuse lobe under kd = 1 - F(h.wi), the paper's eq. 3."""
    polar, d_polar = panels(np.array([0, np.pi / 2]), nodes)
    phi, d_phi = panels(np.array([0, np.pi]), nodes)
    product = np.sin(theta) * np.sin(polar) * np.cos(phi)[:, None] + np.cos(theta) * np.cos(polar)
    kd = 1 - schlick(f0, np.sqrt((1 + product) / 2))
    return float(d_phi @ kd @ (d_polar * np.sin(2 * polar)) / np.pi)


def schlick(f0: float, cosine: np.ndarray) -> np.ndarray:
    """Schlick 1994, eq. 15."""
    return f0 + (1 - f0) * (1 - cosine) ** 5


@dataclass(frozen=True)
class Departure:
    """A figure and where it is found: roughness, angle from the normal (degrees), GGX weight."""

    figure: float
    roughness: float
    angle: float
    weight: float


Quantity = Literal["weak", "albedo", "surface", "shortcut"]


@dataclass(frozen=True)
class EnergyClaim:
    """Both furnaces for both maskings, over roughness x angle x weight.

    Attributes:
        roughness: (r,) perceptual; both lobes have alpha = roughness².
        angles: (a,) of wo from the normal, degrees.
        weights: (k,) shares of GGX, in D and in G alike.
        figures: by quantity and masking, (r, a, k): `weak` is W; `albedo` is A of the specular
            lobe at F = 1; `surface` is A of a white dielectric, F0 = F0_DIELECTRIC with its
            diffuse lobe of albedo 1; `shortcut` is the same with kd = 1 - F(n.wo) instead of
            1 - F(h.wi), as the paper's shader has to take it (eq. 6).
        weights_apart: W of `paper` for GGX's masking alone on Beckmann facets alone, its worst.
        widths_apart: least and most W of `paper` for lobes of different roughness, in the range
            of `roughness`, at weight 1/2 and the last angle. The equations allow it; the paper's
            renderer and this one have a single roughness.
    """

    roughness: tuple[float, ...]
    angles: tuple[float, ...]
    weights: tuple[float, ...]
    figures: dict[tuple[Quantity, Masking], np.ndarray]
    weights_apart: Departure
    widths_apart: tuple[float, float]

    def least(self, quantity: Quantity, masking: Masking) -> Departure:
        """The smallest figure."""
        return self._at(quantity, masking, np.argmin)

    def most(self, quantity: Quantity, masking: Masking) -> Departure:
        """The largest figure."""
        return self._at(quantity, masking, np.argmax)

    def _at(self, quantity: Quantity, masking: Masking, find: Callable) -> Departure:
        values = self.figures[quantity, masking]
        # Rounded first: among equals the first is named, not the one that rounding errors choose.
        r, a, k = np.unravel_index(find(values.round(6)), values.shape)
        return Departure(float(values[r, a, k]), self.roughness[r], self.angles[a], self.weights[k])


ROUGHNESS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0, 70.0, 75.0, 80.0, 83.0, 85.0, 87.0, 89.0)
WEIGHTS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
F0_DIELECTRIC = 0.04
MASKINGS: tuple[Masking, ...] = ("paper", "smith")


@cache
def energy_claim() -> EnergyClaim:
    """The paper's claim, tested; the same for every run. Takes about a second."""
    weights = np.array(WEIGHTS)
    shape = (len(ROUGHNESS), len(ANGLES), len(WEIGHTS))
    figures = {
        (name, masking): np.empty(shape) for name in get_args(Quantity) for masking in MASKINGS
    }
    for a, theta in enumerate(np.radians(ANGLES)):
        diffuse = diffuse_albedo(theta, F0_DIELECTRIC)
        shortcut = 1 - schlick(F0_DIELECTRIC, np.cos(theta))
        for r, roughness in enumerate(ROUGHNESS):
            for masking in MASKINGS:
                surface = Surface((roughness**2, roughness**2), weights, masking)
                mirror, dielectric = furnace_albedo(surface, theta, (1, F0_DIELECTRIC))
                figures["weak", masking][r, a] = weak_furnace(surface, theta)
                figures["albedo", masking][r, a] = mirror
                figures["surface", masking][r, a] = dielectric + diffuse
                figures["shortcut", masking][r, a] = dielectric + shortcut
    apart = [
        Departure(float(weak_furnace(surface, np.radians(ANGLES[-1]))[0]), roughness, ANGLES[-1], 0)
        for roughness in ROUGHNESS
        for surface in [Surface((roughness**2,) * 2, np.zeros(1), "paper", np.ones(1))]
    ]
    low, high = ROUGHNESS[0] ** 2, ROUGHNESS[-1] ** 2
    widths = [
        float(weak_furnace(Surface(pair, np.full(1, 0.5), "paper"), np.radians(ANGLES[-1]))[0])
        for pair in ((high, low), (low, high))
    ]
    return EnergyClaim(
        roughness=ROUGHNESS,
        angles=ANGLES,
        weights=WEIGHTS,
        figures=figures,
        weights_apart=min(apart, key=lambda d: d.figure),
        widths_apart=(widths[0], widths[1]),
    )
