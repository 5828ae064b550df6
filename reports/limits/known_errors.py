"""Errors of known size: a changed case to draw, or a changed picture."""

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import trimesh

from scenes.mesh import load_mesh
from scenes.schema import Case, Material, Object, Optics


@dataclass(frozen=True)
class KnownError:
    """An error of any size; 0 changes nothing.

    Attributes:
        parameter, unit: what is wrong, and what its sizes are in.
        largest: the largest size that is tried, either way.
        case: the case to draw in place of one, for a signed size.
        picture: what to make of (h, w, 3) linear radiance, for a signed size.
    """

    parameter: str
    unit: Literal["", "relative", "degrees"]
    largest: float
    case: Callable[[Case, float], Case] = lambda case, _: case
    picture: Callable[[np.ndarray, float], np.ndarray] = lambda rgb, _: rgb


def known_errors(folder: Path) -> list[KnownError]:
    """Every error that limits are measured for.

    Args:
        folder: where meshes with other normals are written.
    """

    def tilt(case: Case, size: float) -> Case:
        return _objects(case, lambda o: o.model_copy(update={"mesh": tilted(o.mesh, size, folder)}))

    def turn(case: Case, size: float) -> Case:
        light = case.environment
        turned = light.model_copy(update={"rotation": light.rotation + size})
        return case.model_copy(update={"environment": turned})

    def widen(case: Case, size: float) -> Case:
        camera = case.camera.model_copy(update={"fov": case.camera.fov * (1 + size)})
        return case.model_copy(update={"camera": camera})

    return [
        KnownError("roughness", "", 0.5, _materials(_moved("roughness"))),
        KnownError("F0", "", 0.5, _materials(_f0)),
        KnownError("weight", "", 1.0, _materials(_moved("weight"))),
        KnownError("normal tilt", "degrees", 45.0, tilt),
        KnownError("environment rotation", "degrees", 90.0, turn),
        KnownError("field of view", "relative", 0.25, widen),
        KnownError("gain", "relative", 0.9, picture=lambda rgb, size: rgb * np.float32(1 + size)),
        KnownError("gain of red", "relative", 0.9, picture=_red),
    ]


def tilted(mesh: str, degrees: float, folder: Path) -> str:
    """The path of a mesh whose normals are turned about its x axis."""
    name = hashlib.sha256(f"{mesh} {degrees!r}".encode()).hexdigest()[:16]
    if not (path := folder / f"{name}.ply").exists():
        made = load_mesh(mesh)
        turned = (
            made.normals
            @ trimesh.transformations.rotation_matrix(math.radians(degrees), (1, 0, 0))[:3, :3].T
        )
        raw = trimesh.Trimesh(made.vertices, made.faces, vertex_normals=turned, process=False)
        raw.export(path, vertex_normal=True)
    return str(path)


def _red(rgb: np.ndarray, size: float) -> np.ndarray:
    return rgb * np.array([1 + size, 1, 1], np.float32)


def _objects(case: Case, change: Callable[[Object], Object]) -> Case:
    return case.model_copy(update={"objects": tuple(change(o) for o in case.objects)})


def _materials(change: Callable[[Material, float], Material]) -> Callable[[Case, float], Case]:
    def changed(case: Case, size: float) -> Case:
        def with_material(obj: Object) -> Object:
            return obj.model_copy(update={"material": change(obj.material, size)})

        return _objects(case, with_material)

    return changed


def _moved(field: str) -> Callable[[Material, float], Material]:
    """A field moved by some size, as far as 0 and 1 let it."""

    def moved(material: Material, size: float) -> Material:
        value = min(max(getattr(material, field) + size, 0.0), 1.0)
        return material.model_copy(update={field: value})

    return moved


def _f0(material: Material, size: float) -> Material:
    """Both parts' F0 moved; above 1 too, as a renderer in error would."""

    def moved(optics: Optics) -> Optics:
        return optics.model_copy(update={"f0": tuple(max(f + size, 0.0) for f in optics.f0)})

    metal = material.metal and moved(material.metal)
    return material.model_copy(update={"f0": moved(material.f0), "metal": metal})
