"""The BRDF of one material beside double precision, as every run of a suite checks it."""

from renderer import probe
from reports.stability.agreement import Agreement, agreement
from reports.stability.directions import directions
from reports.stability.models import model_brdf
from scenes.schema import Material, Model


def beside_oracle(material: Material, model: Model) -> Agreement:
    """The GLSL BRDF of a material beside double precision."""
    wi, wo = directions(material.alpha)
    ours = probe.brdf_values(material, wi, wo, model)
    theirs = model_brdf(material, wi, wo, model)
    return agreement(material, model.masking, "double precision", ours, theirs, wi, wo)
