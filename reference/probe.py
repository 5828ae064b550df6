"""The reference's BRDF for arrays of directions, for tests and checks."""

import numpy as np

from reference.variant import mitsuba
from scenes.schema import PAPER, Material, Model, Object


def brdf_values(
    material: Material, wi: np.ndarray, wo: np.ndarray, model: Model = PAPER
) -> np.ndarray:
    """f(wi, wo) without the cosine, (n, 3), for unit directions (n, 3) in the frame n = +z."""
    mi = mitsuba()
    import drjit as dr

    from reference.scene_dict import model_bsdf

    si = dr.zeros(mi.SurfaceInteraction3f, len(wi))
    si.wi = mi.Vector3f(np.ascontiguousarray(wi.T))
    light = mi.Vector3f(np.ascontiguousarray(wo.T))
    bsdf, _ = model_bsdf(Object(name="surface", mesh="sphere", material=material), model)
    value = mi.load_dict(bsdf).eval(mi.BSDFContext(), si, light)
    return (value / light.z).numpy().T
