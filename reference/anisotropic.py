"""The facets of `reference.mixture` where their slopes differ along and across the tangent.

`alpha` is (2,): along x, the tangent, and along y. Stretching a surface by it turns isotropic
facets of width 1 into these (Heitz 2014, 5.3), so every formula is the isotropic one of stretched
directions.
"""

import drjit as dr

from reference.variant import mitsuba

mi = mitsuba()


def D_ggx(h, alpha):
    """Heitz 2014, eq. 85; Burley 2012, eq. 13, has it with the same exponent."""
    spread = _slope2(h, alpha) + dr.square(h.z)
    return dr.inv_pi / (alpha.x * alpha.y * dr.square(spread)) & (h.z > 0)


def D_beckmann(h, alpha):
    """Walter et al. 2007, eq. 25, stretched; its limit at n.h = 0 is 0."""
    z2 = dr.square(h.z)
    peak = dr.inv_pi / (alpha.x * alpha.y * dr.square(z2))
    return dr.select(h.z > 1e-6, dr.exp(-_slope2(h, alpha) / z2) * peak, 0)


def projected_area_ggx(w, alpha):
    """n.w / G1(w); Heitz 2014, eq. 86 with the width of eq. 80."""
    return (w.z + dr.sqrt(dr.square(w.z) + dr.square(_aside(w, alpha)))) / 2


def projected_area_beckmann(w, alpha):
    """n.w (1 + Lambda(w)); Heitz 2014, eq. 68 with the width of eq. 80."""
    aside = _aside(w, alpha)
    a = w.z / dr.maximum(aside, 1e-12)
    tail = aside * dr.exp(-dr.square(a)) * (0.5 / dr.sqrt(dr.pi))
    return w.z * (1 + dr.erf(a)) / 2 + tail


def visible_ggx(wi, sample, alpha):
    """A normal seen from wi. Dupuy and Benyoub 2023, listing 3."""
    stretched = dr.normalize(mi.Vector3f(wi.x * alpha.x, wi.y * alpha.y, wi.z))
    z = dr.fma(1 - sample.y, 1 + stretched.z, -stretched.z)
    s, c = dr.sincos(2 * dr.pi * sample.x)
    r = dr.safe_sqrt(1 - dr.square(z))
    cap = mi.Vector3f(r * c, r * s, z) + stretched
    return dr.normalize(mi.Vector3f(cap.x * alpha.x, cap.y * alpha.y, dr.maximum(cap.z, 0)))


def visible_beckmann(wi, sample, alpha):
    """A normal seen from wi. Jakob 2014, as Mitsuba has it."""
    facets = mi.MicrofacetDistribution(mi.MicrofacetType.Beckmann, alpha.x, alpha.y)
    return facets.sample(wi, sample)[0]


def _slope2(h, alpha):
    return dr.square(h.x / alpha.x) + dr.square(h.y / alpha.y)


def _aside(w, alpha):
    """sin(theta) times the width along w's own azimuth (Heitz 2014, eq. 80)."""
    return dr.sqrt(dr.square(alpha.x * w.x) + dr.square(alpha.y * w.y))
