"""A case in Blender's terms, as arrays and JSON that need nothing of this project to be read."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from scenes.camera import camera_to_world
from scenes.environment import load_environment
from scenes.errors import InputError
from scenes.mesh import world_mesh
from scenes.schema import Case, Object

# Below this, an interface is there for form only: `roughplastic` refuses an index of exactly 1,
# and with 1.0001 (F0 2.5e-9) it is Lambertian within .02 % up to 84 degrees.
NO_INTERFACE = 1e-8


def write_scene(case: Case, folder: Path) -> None:
    """Write scene.json and scene.npz, all that blender.py reads.

    scene.npz holds `environment` (H, W, 3), and per object i `vertices_i` (n, 3) and `normals_i`
    (n, 3) in world space and `faces_i` (m, 3).

    Raises:
        InputError: a material has no twin in Cycles, or a file cannot be read.
    """
    arrays = {"environment": load_environment(case.environment.path).radiance}
    for number, obj in enumerate(case.objects):
        mesh = world_mesh(obj)
        arrays[f"vertices_{number}"] = mesh.vertices
        arrays[f"normals_{number}"] = mesh.normals
        arrays[f"faces_{number}"] = mesh.faces
    scene = {
        "width": case.width,
        "height": case.height,
        "fov": case.camera.fov,
        "camera": camera_to_world(case.camera).tolist(),
        "environment": environment_mapping(len(arrays["environment"]), case.environment.rotation),
        "materials": [cycles_material(obj) for obj in case.objects],
    }
    np.savez(folder / "scene.npz", **arrays)
    (folder / "scene.json").write_text(json.dumps(scene))


def environment_mapping(rows: int, rotation: float) -> dict[str, float]:
    """Where a direction lies on the picture of a radiance map, both axes in [0, 1], v = 0 below.

    u = atan2(x, y) / (2 pi) + turn; v = 1 - (theta * scale + offset): row r, counted from the
    top, lies at theta = pi r / (rows - 1), and its texel's centre at (r + 1/2) / rows.
    """
    return {
        "turn": rotation / 360,
        "scale": (rows - 1) / (np.pi * rows),
        "offset": 0.5 / rows,
    }


def cycles_material(obj: Object) -> dict[str, Any]:
    """The Cycles surface of an object: `kind` and what goes into its node.

    - `diffuse`: Lambert, for a dielectric whose interface does not reflect (NO_INTERFACE).
    - `conductor`: eta and k, one microfacet lobe; the twin of the truth `physical`.
    - `schlick`: Schlick's Fresnel from a bare F0; the twin of the paper's model, so of `global`.
    - `principled`: any other dielectric. No twin of anything here; reported only.

    Raises:
        InputError: a mixture of lobes or of metal and dielectric, which Cycles does not have, or a
            dielectric without eta.
    """
    material, where = obj.material, f"object '{obj.name}'"
    if material.weight not in (0, 1) or material.masking_weight != material.weight:
        problem = "mixes GGX and Beckmann, which Cycles has no surface for"
        raise InputError(where, "material.weight", problem, "give weight 0 or 1 for D and G")
    if material.metallic not in (0, 1):
        problem = "is part metal, which Cycles has no surface for"
        raise InputError(where, "material.metallic", problem, "give 0 or 1")
    if material.metallic == 0 and max(material.f0.f0) < NO_INTERFACE:
        return {"kind": "diffuse", "colour": material.albedo}
    lobe = {
        "alpha": material.alpha,
        "distribution": "GGX" if material.weight == 1 else "BECKMANN",
    }
    if material.metallic == 1 and material.metal.eta is None:
        return lobe | {"kind": "schlick", "f0": material.metal.f0}
    if material.metallic == 1:
        return lobe | {"kind": "conductor", "eta": material.metal.eta, "k": material.metal.k}
    if material.weight == 0:
        problem = "is a Beckmann dielectric, which Blender's principled surface does not have"
        raise InputError(where, "material.weight", problem, "give weight 1")
    if material.f0.eta is None:
        problem = "has no eta, which Blender's principled surface needs"
        raise InputError(where, "material.f0", problem, "add eta, or give an F0 below 1")
    return {
        "kind": "principled",
        "colour": material.albedo,
        "alpha": material.alpha,
        "eta": float(np.mean(material.f0.eta)),
    }
