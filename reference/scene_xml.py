"""A case as Mitsuba's own XML, with stock plugins alone: what anybody can render without us."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np
import trimesh

from reference.physical import physical_bsdf
from reference.settings import PATH
from reference.variant import mitsuba
from scenes.environment import load_environment
from scenes.frame import write_exr
from scenes.mesh import Mesh, world_mesh
from scenes.schema import Case

mi = mitsuba()

VERSION = "3.0.0"  # of Mitsuba's scene format
SAMPLES = 256  # a pixel, unless asked otherwise: mitsuba -D spp=...


def write_scene_xml(case: Case, folder: Path) -> None:
    """Write scene.xml, a PLY for each object and environment.exr into a folder.

    It is the truth `physical`: roughconductor and roughplastic from eta and k, path-traced.

    Raises:
        InputError: a material is like no stock plugin.
    """
    scene = xml.Element("scene", version=VERSION)
    xml.SubElement(scene, "default", name="spp", value=str(SAMPLES))
    _plugin(scene, "integrator", PATH)
    _sensor(scene, case)
    _environment(scene, case, folder)
    for number, obj in enumerate(case.objects):
        shape = xml.SubElement(scene, "shape", type="ply", id=obj.name)
        name = f"object_{number:03}.ply"
        _write_ply(world_mesh(obj), folder / name)
        xml.SubElement(shape, "string", name="filename", value=name)
        bsdf, _ = physical_bsdf(obj)
        _bsdf(shape, bsdf, folder, f"object_{number:03}")
    xml.indent(scene, " ")
    text = xml.tostring(scene, encoding="unicode") + "\n"
    (folder / "scene.xml").write_text(text, encoding="utf-8")


def _write_ply(mesh: Mesh, path: Path) -> None:
    """Triangles with normals, and texture coordinates if there are any, as binary PLY."""
    made = trimesh.Trimesh(mesh.vertices, mesh.faces, vertex_normals=mesh.normals, process=False)
    if "uv" in mesh.carried:  # under the names that Mitsuba reads
        made.vertex_attributes = dict(zip("uv", mesh.carried["uv"].T, strict=True))
    made.export(path, vertex_normal=True)


def _sensor(scene: xml.Element, case: Case) -> None:
    sensor = xml.SubElement(scene, "sensor", type="perspective")
    xml.SubElement(sensor, "string", name="fov_axis", value="y")
    xml.SubElement(sensor, "float", name="fov", value=repr(case.camera.fov))
    transform = xml.SubElement(sensor, "transform", name="to_world")
    look = {n: ", ".join(map(repr, getattr(case.camera, n))) for n in ("origin", "target", "up")}
    xml.SubElement(transform, "lookat", **look)
    sampler = xml.SubElement(sensor, "sampler", type="independent")
    xml.SubElement(sampler, "integer", name="sample_count", value="$spp")
    film = {"type": "hdrfilm", "width": case.width, "height": case.height}
    film |= {"component_format": "float32", "pixel_format": "rgb"}
    xml.SubElement(_plugin(sensor, "film", film), "rfilter", type="box")


def _environment(scene: xml.Element, case: Case, folder: Path) -> None:
    """As `scene_dict.environment` has it."""
    radiance = np.ascontiguousarray(load_environment(case.environment.path).radiance, np.float32)
    write_exr(folder / "environment.exr", radiance, ["R", "G", "B"])
    light = xml.SubElement(scene, "emitter", type="envmap")
    xml.SubElement(light, "string", name="filename", value="environment.exr")
    transform = xml.SubElement(light, "transform", name="to_world")
    xml.SubElement(transform, "rotate", x="1", angle="90")
    xml.SubElement(transform, "rotate", z="1", angle=repr(case.environment.rotation))


def _bsdf(
    parent: xml.Element, bsdf: Mapping[str, Any], folder: Path, stem: str, name: str = ""
) -> None:
    """A BSDF and what is in it; textures of one texel become files."""
    made = xml.SubElement(parent, "bsdf", type=bsdf["type"], **({"name": name} if name else {}))
    for key, value in bsdf.items():
        if isinstance(value, Mapping) and value["type"] == "rgb":
            told = ", ".join(repr(float(v)) for v in value["value"])
            xml.SubElement(made, "rgb", name=key, value=told)
        elif isinstance(value, Mapping) and value["type"] == "bitmap":
            texel = np.array(value["bitmap"], np.float32).reshape(1, 1, 3)
            file = f"{stem}_{bsdf['distribution']}_{key}.exr"
            write_exr(folder / file, texel, ["R", "G", "B"])
            texture = xml.SubElement(made, "texture", type="bitmap", name=key)
            xml.SubElement(texture, "string", name="filename", value=file)
            xml.SubElement(texture, "boolean", name="raw", value="true")
            xml.SubElement(texture, "string", name="filter_type", value=value["filter_type"])
        elif isinstance(value, Mapping):
            _bsdf(made, value, folder, stem, key)
        elif key != "type":
            _number(made, key, value)


def _plugin(parent: xml.Element, kind: str, fields: Mapping[str, Any]) -> xml.Element:
    made = xml.SubElement(parent, kind, type=fields["type"])
    for key, value in fields.items():
        if key != "type":
            _number(made, key, value)
    return made


def _number(parent: xml.Element, name: str, value: bool | int | float | str) -> None:
    kinds = {bool: "boolean", int: "integer", float: "float", str: "string"}
    shown = str(value).lower() if isinstance(value, bool) else str(value)
    xml.SubElement(parent, kinds[type(value)], name=name, value=shown)
