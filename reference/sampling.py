"""What estimators share: how two kinds of sample are joined, and the diffuse lobe alone."""

from functools import cache

import drjit as dr

from reference.variant import mitsuba

mi = mitsuba()


def power_heuristic(own: mi.Float, other: mi.Float) -> mi.Float:
    """The weight of a sample of density `own` that could also come with density `other`."""
    return dr.select(own > 0, dr.square(own) / (dr.square(own) + dr.square(other)), 0)


@cache
def diffuse_only() -> mi.BSDFContext:
    """A context that asks a BSDF for its diffuse lobe."""
    context = mi.BSDFContext()
    context.type_mask = +mi.BSDFFlags.Diffuse
    return context
