"""Mistakes that outside renderers make: what each draws in place of a case, and how to mend it."""

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.ndimage import map_coordinates

from reports.display import display
from reports.doctor.scenes import directions, write_light, write_mesh
from scenes.environment import load_environment
from scenes.mesh import load_mesh
from scenes.schema import Case, Material, Object

Redraw = Callable[[Case, Path], Case]  # what is drawn in place of a case; files go into a folder
Regrade = Callable[[np.ndarray], np.ndarray]  # what becomes of a picture (h, w, 3)


@dataclass(frozen=True)
class Mistake:
    """One thing that can be wrong.

    Attributes:
        kind: mistakes of one kind exclude each other.
        words: what is wrong, after "it looks as if".
        remedy: where to look.
        case, picture: what it does to a case, or to the finished picture.
        order: of picture mistakes, which is done first.
    """

    kind: str
    words: str
    remedy: str
    case: Redraw = field(default=lambda case, _: case)
    picture: Regrade = field(default=lambda rgb: rgb)
    order: int = 0


def turned(angle: float) -> Mistake:
    """The environment turned about the vertical."""

    def redraw(case: Case, _: Path) -> Case:
        light = case.environment
        return _with(case, environment=light.model_copy(update={"rotation": angle}))

    return Mistake(
        "turn",
        f"the environment is turned by {angle:g} degrees",
        "column u of the map lies at azimuth 2 pi u from +y towards +x, plus `rotation`",
        redraw,
    )


def gained(factor: float, words: str = "") -> Mistake:
    """Light multiplied by a number."""
    shown = f"{factor:.3g} times" if factor >= 1 else f"1/{1 / factor:.3g} of"
    return Mistake(
        "gain",
        f"light is {shown} what it should be{words}",
        "a diffuse surface reflects albedo / pi times its irradiance; look for exposure, a lost "
        "or doubled pi, and an intensity of the environment",
        picture=lambda rgb: rgb * factor,
        order=2,
    )


KNOWN_GAINS = (
    (math.pi, ": pi, which the diffuse lobe is to be divided by"),
    (1 / math.pi, ": by pi, divided by once too often"),
)


def gain_near(factor: float) -> Mistake:
    """The mistake of a measured factor; by name where it is a known one."""
    for known, words in KNOWN_GAINS:
        if abs(math.log(factor / known)) < 0.04:
            return gained(known, words)
    return gained(factor)


def _with(case: Case, **fields: object) -> Case:
    return case.model_copy(update=fields)


def _relit(change: Callable[[np.ndarray], np.ndarray]) -> Redraw:
    """A case in the light of a changed map."""

    def redraw(case: Case, folder: Path) -> Case:
        radiance = change(load_environment(case.environment.path).radiance)
        digest = hashlib.sha256(np.ascontiguousarray(radiance).tobytes()).hexdigest()[:16]
        path = write_light(folder / f"{digest}.exr", radiance)
        return _with(case, environment=case.environment.model_copy(update={"path": path}))

    return redraw


def _pole_along_y(radiance: np.ndarray) -> np.ndarray:
    """The map as one sees it whose world has y up: (x, y, z) is taken for (x, z, -y)."""
    rows, columns = radiance.shape[:2]
    x, y, z = np.moveaxis(directions(rows, columns), -1, 0)
    theta, phi = np.arccos(np.clip(y, -1, 1)), np.arctan2(x, -z)
    at = [theta / np.pi * (rows - 1), (phi / (2 * np.pi)) % 1 * columns - 0.5]
    channels = [
        map_coordinates(c, at, order=1, mode="grid-wrap") for c in np.moveaxis(radiance, -1, 0)
    ]
    return np.stack(channels, axis=-1)


def _zoomed(fov: Callable[[float, float], float]) -> Redraw:
    """A case seen with another field of view, from its own and the aspect."""

    def redraw(case: Case, _: Path) -> Case:
        angle = fov(math.radians(case.camera.fov), case.width / case.height)
        return _with(case, camera=case.camera.model_copy(update={"fov": math.degrees(angle)}))

    return redraw


def _resurfaced(change: Callable[[Material], Material]) -> Redraw:
    def redraw(case: Case, _: Path) -> Case:
        objects = (o.model_copy(update={"material": change(o.material)}) for o in case.objects)
        return _with(case, objects=tuple(objects))

    return redraw


def _faceted(case: Case, folder: Path) -> Case:
    """Each triangle of meshes from files with its own normal."""

    def flat(obj: Object) -> Object:
        if not obj.mesh.endswith(".ply"):
            return obj
        mesh = load_mesh(obj.mesh)
        corners = mesh.vertices[mesh.faces].astype(float)
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        faces = np.arange(3 * len(corners)).reshape(-1, 3)
        path = folder / f"flat-{Path(obj.mesh).name}"
        told = write_mesh(path, corners.reshape(-1, 3), faces, np.repeat(normals, 3, axis=0))
        return obj.model_copy(update={"mesh": told})

    return _with(case, objects=tuple(map(flat, case.objects)))


def _as_dielectric(material: Material) -> Material:
    if material.metal is None:
        return material
    return material.model_copy(update={"metallic": 0.0, "albedo": material.metal.f0})


def _rougher(power: float) -> Callable[[Material], Material]:
    return lambda m: m.model_copy(update={"roughness": m.roughness**power})


FACETS = "triangles are shaded with their own normals"
MISTAKES = (
    *(turned(angle) for angle in (90.0, 180.0, 270.0)),
    Mistake(
        "map",
        "the environment is upside down (v flipped)",
        "row 0 of the map is the top of the sky, +z",
        _relit(lambda light: light[::-1]),
    ),
    Mistake(
        "map",
        "the environment is mirrored (u flipped)",
        "azimuth grows from +y towards +x; seen from inside, columns run to the right",
        _relit(lambda light: light[:, ::-1]),
    ),
    Mistake(
        "map",
        "the environment's pole points along y",
        "the world has z up",
        _relit(_pole_along_y),
    ),
    Mistake(
        "normals",
        f"{FACETS} (faceted)",
        "interpolate the normals that the mesh stores",
        _faceted,
    ),
    Mistake(
        "view",
        "the field of view is taken as horizontal",
        "camera.fov is vertical",
        _zoomed(lambda fov, aspect: 2 * math.atan(math.tan(fov / 2) / aspect)),
    ),
    Mistake(
        "view",
        "the field of view is taken as half of itself, or doubled",
        "camera.fov is the whole angle from bottom to top",
        _zoomed(lambda fov, _: 2 * fov),
    ),
    Mistake(
        "roughness",
        "roughness is used as alpha",
        "alpha = roughness²",
        _resurfaced(_rougher(0.5)),
    ),
    Mistake(
        "roughness",
        "roughness is squared twice",
        "alpha = roughness², once",
        _resurfaced(_rougher(2.0)),
    ),
    Mistake(
        "metal",
        "metals are drawn as dielectrics",
        "with metallic = 1 there is no diffuse lobe, and F0 is metal.f0",
        _resurfaced(_as_dielectric),
    ),
    Mistake(
        "flip",
        "the picture is upside down",
        "row 0 of the EXR is on top",
        picture=lambda rgb: rgb[::-1],
    ),
    Mistake(
        "flip",
        "the picture is mirrored",
        "right is forward x up",
        picture=lambda rgb: rgb[:, ::-1],
    ),
    Mistake(
        "channels",
        "red and blue are exchanged",
        "the channels are named R, G and B",
        picture=lambda rgb: rgb[..., ::-1],
        order=1,
    ),
    Mistake(
        "encoding",
        "values are sRGB-encoded",
        "write linear radiance, without a display transform",
        picture=lambda rgb: display(rgb, 1.0),
        order=4,
    ),
    Mistake(
        "encoding",
        "values are cut off at 1",
        "write linear radiance as floats, without tone mapping",
        picture=lambda rgb: np.minimum(rgb, 1.0),
        order=3,
    ),
)
# Tried where nothing else explains the light: any other turn.
OTHER_TURNS = tuple(turned(float(a)) for a in range(15, 360, 15) if a % 90)
