"""Draw an exported case with Blender's Cycles; runs under a Python that has bpy, alone.

python -I blender.py FOLDER OUT.exr SAMPLES SEED, with scene.json and scene.npz in FOLDER.
Everything that Cycles does beyond path tracing is off, and the paths are as long as ours.
"""

import json
import math
import sys
from pathlib import Path

import bpy
import numpy as np


def main(folder: Path, out: Path, samples: int, seed: int) -> None:
    """Build the scene, render it, write linear RGB float32."""
    scene = json.loads((folder / "scene.json").read_text())
    arrays = np.load(folder / "scene.npz")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    settings(scene["width"], scene["height"], samples, seed)
    for number, material in enumerate(scene["materials"]):
        parts = (arrays[f"{name}_{number}"] for name in ("vertices", "normals", "faces"))
        add_mesh(f"object_{number:03}", *parts, surface(material))
    add_camera(scene)
    add_environment(arrays["environment"], **scene["environment"])
    bpy.context.scene.render.filepath = str(out)
    bpy.ops.render.render(write_still=True)


def add_mesh(name, vertices, normals, faces, material) -> None:
    """Triangles with exactly the given normals at their vertices."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.shade_smooth()
    # As a vector attribute they stay float; `normals_split_custom_set` would round them to 16 bit.
    attribute = mesh.attributes.new("custom_normal", "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", np.ascontiguousarray(normals, np.float32).ravel())
    mesh.update()
    mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    # Both move shadows away from where the light is blocked.
    thing.cycles.shadow_terminator_offset = 0
    thing.cycles.shadow_terminator_geometry_offset = 0
    bpy.context.collection.objects.link(thing)


def surface(description: dict):
    """The material of export.cycles_material, as one node."""
    material = bpy.data.materials.new(description["kind"])
    # On, Cycles bends shading normals until the mirror direction clears the triangle.
    material.cycles.use_bump_map_correction = False
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    node = {
        "diffuse": _diffuse,
        "conductor": _conductor,
        "schlick": _schlick,
        "principled": _principled,
    }[description["kind"]](nodes, description)
    links.new(node.outputs["BSDF"], output.inputs["Surface"])
    return material


def _diffuse(nodes, given):
    node = nodes.new("ShaderNodeBsdfDiffuse")
    node.inputs["Color"].default_value = (*given["colour"], 1)
    node.inputs["Roughness"].default_value = 0  # Lambert
    return node


def _metallic(nodes, given, fresnel):
    node = nodes.new("ShaderNodeBsdfMetallic")
    node.distribution = given["distribution"]  # GGX, not MULTI_GGX: single scattering
    node.fresnel_type = fresnel
    node.inputs["Roughness"].default_value = math.sqrt(given["alpha"])
    return node


def _conductor(nodes, given):
    node = _metallic(nodes, given, "PHYSICAL_CONDUCTOR")
    node.inputs["IOR"].default_value = given["eta"]
    node.inputs["Extinction"].default_value = given["k"]
    return node


def _schlick(nodes, given):
    node = _metallic(nodes, given, "F82")
    node.inputs["Base Color"].default_value = (*given["f0"], 1)
    node.inputs["Edge Tint"].default_value = (1, 1, 1, 1)  # no dip at 82 degrees: Schlick's curve
    return node


def _principled(nodes, given):
    node = nodes.new("ShaderNodeBsdfPrincipled")
    node.distribution = "GGX"
    node.inputs["Base Color"].default_value = (*given["colour"], 1)
    node.inputs["Roughness"].default_value = math.sqrt(given["alpha"])
    node.inputs["IOR"].default_value = given["eta"]
    return node


def add_camera(scene: dict) -> None:
    """A pinhole of vertical field of view."""
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "VERTICAL"
    camera.angle = math.radians(scene["fov"])
    camera.clip_start, camera.clip_end = 1e-6, 1e9
    thing = bpy.data.objects.new("camera", camera)
    thing.matrix_world = np.array(scene["camera"]).T.tolist()  # Blender takes columns
    bpy.context.collection.objects.link(thing)
    bpy.context.scene.camera = thing


def add_environment(radiance: np.ndarray, turn: float, scale: float, offset: float) -> None:
    """The map looked up by export.environment_mapping, in nodes.

    Blender's own environment node puts texel centres half a row away from the poles; ours lie on
    them, so the picture's coordinates are computed here.
    """
    rows, columns = radiance.shape[:2]
    image = bpy.data.images.new("environment", columns, rows, alpha=False, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"  # the numbers as they are
    image.use_half_precision = False
    pixels = np.ones((rows, columns, 4), np.float32)
    pixels[..., :3] = radiance[::-1]  # Blender's row 0 is the bottom
    image.pixels.foreach_set(pixels.ravel())
    image.update()

    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    nodes, links = world.node_tree.nodes, world.node_tree.links
    nodes.clear()

    def math_node(operation: str, *inputs):
        node = nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, value in zip(node.inputs, inputs, strict=False):
            if isinstance(value, (int, float)):
                socket.default_value = value
            else:
                links.new(value, socket)
        return node.outputs[0]

    direction = nodes.new("ShaderNodeSeparateXYZ")
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Generated"], direction.inputs[0])
    x, y, z = direction.outputs
    turns = math_node("DIVIDE", math_node("ARCTAN2", x, y), 2 * math.pi)
    column = math_node("ADD", turns, turn)
    # acos(z) loses its digits at the poles; atan2 keeps them.
    across = math_node(
        "SQRT", math_node("ADD", math_node("MULTIPLY", x, x), math_node("MULTIPLY", y, y))
    )
    theta = math_node("ARCTAN2", across, z)
    down = math_node("MULTIPLY_ADD", theta, scale, offset)
    place = nodes.new("ShaderNodeCombineXYZ")
    links.new(column, place.inputs[0])
    links.new(math_node("SUBTRACT", 1.0, down), place.inputs[1])
    texture = nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation, texture.extension = image, "Linear", "REPEAT"
    links.new(place.outputs[0], texture.inputs[0])
    background = nodes.new("ShaderNodeBackground")
    links.new(texture.outputs["Color"], background.inputs["Color"])
    links.new(background.outputs[0], nodes.new("ShaderNodeOutputWorld").inputs["Surface"])
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = 2048  # of the importance map: noise, not values


def settings(width: int, height: int, samples: int, seed: int) -> None:
    """Plain path tracing, 64 bounces, box filter, nothing clamped, blurred or denoised."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"  # from here on materials, objects and worlds have `.cycles`
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = False
    scene.render.dither_intensity = 0
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples, cycles.seed = samples, seed
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1.0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = 64
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = 0
    cycles.light_sampling_threshold = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.film_exposure = 1.0


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]))
