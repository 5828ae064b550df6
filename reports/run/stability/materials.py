"""The BRDF of one material beside double precision, as every run of a suite checks it."""

from renderer import probe
from reports.stability import anisotropic
from reports.stability.agreement import Agreement, agreement
from reports.stability.directions import directions
from reports.stability.models import model_brdf
from scenes.schema import Material, Model


def beside_oracle(material: Material, model: Model) -> Agreement:
    """The GLSL BRDF of a material beside double precision; of one with maps, its numbers."""
    wi, wo = directions(material.alpha)
    ours = probe.brdf_values(material, wi, wo, model)
    truth = anisotropic.brdf if material.anisotropy else model_brdf
    theirs = truth(material, wi, wo, model)
    return agreement(material, model.masking, "double precision", ours, theirs, wi, wo)
