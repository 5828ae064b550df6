"""What the shaders are told of a material: its uniforms, under a model."""

from typing import Any

from scenes.schema import PAPER, Material, Model


def surface_uniforms(material: Material, model: Model = PAPER) -> dict[str, Any]:
    """The uniforms of drawn_material.glsl, but for `multiscatter`, which is precomputed.

    Raises:
        ValueError: the model needs an eta that the material does not have.
    """
    found = {
        "albedo": material.diffuse_albedo,
        "f0": material.specular_f0,
        "alpha": material.alpha,
        "weight_d": (material.weight, 1 - material.weight),
        "weight_g": (material.masking_weight, 1 - material.masking_weight),
    }
    if model.fresnel == "f82":
        found["f82"] = material.specular_f82
    elif model.fresnel == "exact":
        found["metallic"] = material.metallic
        if material.metallic < 1:
            found["eta"] = material.one_eta
        if material.metallic > 0:
            found["metal_eta"], found["metal_k"] = material.metal_index
    return found
