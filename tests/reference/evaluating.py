"""BSDFs asked for values and samples, direction by direction."""

import drjit as dr
import numpy as np

from reference.variant import mitsuba

mi = mitsuba()


def evaluate(bsdf, wi, wo, context=None):
    """f cos(theta_o), (n, 3)."""
    si = dr.zeros(mi.SurfaceInteraction3f, len(wi))
    si.wi = mi.Vector3f(wi.T.astype(np.float32))
    wo = mi.Vector3f(wo.T.astype(np.float32))
    return np.array(bsdf.eval(context or mi.BSDFContext(), si, wo)).T.astype(float)


def only(flag):
    """A context that asks for one kind of light."""
    context = mi.BSDFContext()
    context.type_mask = flag
    return context


def directions(alpha, count=20_000):
    """Pairs above the surface, half of them near the mirror direction, (n, 3) float32 values."""
    rng = np.random.default_rng(1)
    wi, wo = rng.normal(size=(2, count, 3))
    wi[:, 2], wo[:, 2] = np.abs(wi[:, 2]), np.abs(wo[:, 2])
    half = count // 2
    wo[:half] = wi[:half] * [-1, -1, 1] + rng.normal(size=(half, 3)) * alpha
    wi, wo = (w / np.linalg.norm(w, axis=1, keepdims=True) for w in (wi, wo))
    wi, wo = (w.astype(np.float32).astype(float) for w in (wi, wo))
    # Where wi and wo are nearly opposite, float32 does not hold enough digits of their sum.
    known = np.linalg.norm(wi + wo, axis=1) > 0.2
    kept = known & (wi[:, 2] > 1e-3) & (wo[:, 2] > 1e-3)
    return wi[kept], wo[kept]


def chi2(bsdf, degrees, context=None):
    """A chi-square test of `sample` against `pdf`, for wi at an angle from the normal."""
    context = context or mi.BSDFContext()
    theta = np.radians(degrees)
    wi = mi.Vector3f(float(np.sin(theta)), 0.0, float(np.cos(theta)))

    def interaction(count):
        si = dr.zeros(mi.SurfaceInteraction3f, count)
        si.wi = wi
        return si

    def draw(sample):
        si = interaction(dr.width(sample))
        bs, weight = bsdf.sample(context, si, sample[0], mi.Point2f(sample[1], sample[2]))
        return bs.wo, dr.select(dr.any(weight != 0), 1.0, 0.0)

    def density(wo):
        return bsdf.pdf(context, interaction(dr.width(wo)), wo)

    return mi.chi2.ChiSquareTest(
        domain=mi.chi2.SphericalDomain(),
        sample_func=draw,
        pdf_func=density,
        sample_dim=3,
        sample_count=200_000,
        res=100,  # even, so that the horizon, where the density ends, is an edge between cells
        ires=16,
    )
