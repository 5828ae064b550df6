"""What the shaders are told of a material: its uniforms, under a model."""

import math
from typing import Any

import numpy as np

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


def material_rows(
    material: Material, model: Model, multiscatter: tuple[float, float, float]
) -> np.ndarray:
    """The same as texels (7, 4) float32, for shaders that meet any material: `material_of`.

    What the model does not ask for is 0, but for eta, which must be an index.
    """
    told = surface_uniforms(material, model)
    rows = np.zeros((7, 4), np.float32)
    rows[0] = (*told["albedo"], told["alpha"])
    rows[1] = (*told["f0"], told["weight_d"][0])
    rows[2] = (told["weight_g"][0], told.get("metallic", 0), told.get("eta", 1), 0)
    rows[3, :3] = told.get("f82", 0)
    rows[4, :3], rows[5, :3] = told.get("metal_eta", 1), told.get("metal_k", 0)
    rows[6, :3] = multiscatter
    return rows


def varying_uniforms(material: Material, directed: bool) -> dict[str, Any]:
    """The numbers of shaders/vary.glsl; with two widths where lobes have a direction."""
    turn = math.radians(material.rotation)
    metal = material.metal or material.f0
    return {
        "base_albedo": material.albedo,
        "base_roughness": material.roughness,
        "base_metallic": material.metallic,
        "base_weight": material.weight,
        "dielectric_f0": material.f0.f0,
        "metal_f0": metal.f0,
        "dielectric_f82": material.model_copy(update={"metallic": 0.0}).specular_f82,
        "metal_f82": material.model_copy(update={"metallic": 1.0}).specular_f82,
        "stretch": material.stretch if directed else 1.0,
        "tangent_turn": (math.cos(turn), math.sin(turn)),
    }
