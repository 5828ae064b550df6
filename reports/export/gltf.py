"""A case as glTF 2.0: geometry, materials and camera. Light and mixtures stand in its JSON."""

import json
import math
from pathlib import Path

import numpy as np
import trimesh
from trimesh.visual.material import PBRMaterial

from scenes.camera import camera_to_world
from scenes.mesh import world_mesh
from scenes.schema import Case, Material, Object

# glTF has y up and looks along -z; our world has z up.
Y_UP = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], float)


def write_gltf(case: Case, path: Path) -> None:
    """Write `path` (.gltf) and its buffers beside it.

    Meshes stand in world space under one node that turns z up to y up. Of a material go albedo (of
    a metal its F0), roughness, metallic and, of a dielectric, the index of refraction
    (KHR_materials_ior); the mixture of lobes stands under `extras`, with all of the material.
    """
    scene = trimesh.Scene()
    for obj in case.objects:
        scene.add_geometry(_geometry(obj), node_name=obj.name, geom_name=obj.name)
    scene.apply_transform(Y_UP)
    files = trimesh.exchange.gltf.export_gltf(scene, include_normals=True)
    tree = json.loads(files.pop("model.gltf"))
    tree["asset"]["generator"] = "shadeproof"
    materials = {o.name: o.material for o in case.objects}
    for material in tree.get("materials", ()):
        _complete(material, materials[material["name"]])
    if any("extensions" in m for m in tree.get("materials", ())):
        tree["extensionsUsed"] = ["KHR_materials_ior"]
    _add_camera(tree, case)
    for number, (name, data) in enumerate(sorted(files.items())):
        own = f"{path.stem}-{number}.bin"
        (path.parent / own).write_bytes(data)
        for buffer in tree["buffers"]:
            if buffer.get("uri") == name:
                buffer["uri"] = own
    path.write_text(json.dumps(tree, indent=1) + "\n", encoding="utf-8")


def _geometry(obj: Object) -> trimesh.Trimesh:
    source = world_mesh(obj)
    mesh = trimesh.Trimesh(
        source.vertices, source.faces, vertex_normals=source.normals, process=False
    )
    material = PBRMaterial(
        name=obj.name,
        baseColorFactor=[*base_colour(obj.material), 1.0],
        metallicFactor=obj.material.metallic,
        roughnessFactor=obj.material.roughness,
    )
    uv = source.carried.get("uv", np.zeros((len(source.vertices), 2)))
    mesh.visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    return mesh


def base_colour(material: Material) -> tuple[float, float, float]:
    """What glTF's base colour is of a material: F0 of a metal, albedo of the rest, mixed."""
    metal = material.metal.f0 if material.metal else material.albedo
    share = material.metallic
    return tuple((1 - share) * a + share * m for a, m in zip(material.albedo, metal, strict=True))


def _complete(told: dict, material: Material) -> None:
    """What trimesh does not write: exact factors, the index of refraction, and our own fields."""
    told["pbrMetallicRoughness"] |= {
        "baseColorFactor": [*base_colour(material), 1.0],
        "metallicFactor": material.metallic,
        "roughnessFactor": material.roughness,
    }
    told["doubleSided"] = False
    if material.metallic < 1 and material.f0.eta is not None:
        told["extensions"] = {"KHR_materials_ior": {"ior": material.one_eta}}
    told["extras"] = {"shadeproof": material.model_dump(mode="json")}


def _add_camera(tree: dict, case: Case) -> None:
    """The camera as a node of its own, in glTF's space."""
    pose = Y_UP @ camera_to_world(case.camera)
    tree["cameras"] = [
        {
            "type": "perspective",
            "perspective": {
                "yfov": math.radians(case.camera.fov),
                "aspectRatio": case.width / case.height,
                "znear": 1e-3 * math.dist(case.camera.origin, case.camera.target),
            },
        }
    ]
    tree["nodes"].append({"name": "camera", "camera": 0, "matrix": pose.T.ravel().tolist()})
    tree["scenes"][0]["nodes"].append(len(tree["nodes"]) - 1)
