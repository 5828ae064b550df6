"""The doctor's cases: each shows some mistakes plainly. Their files are written into a folder."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import trimesh

from scenes.frame import write_exr
from scenes.schema import Camera, Case, Environment, Material, Object

SIZE = (144, 96)  # wider than high, or a field of view could be either's
# Nothing stands in the middle, and above is not below: a flip moves everything.
CAMERA = Camera(origin=(0.6, -5.0, 0.9), target=(0.1, 0.0, 0.15), fov=30)
ROWS, COLUMNS = 64, 128
SUN_AT, SUN = (18, 74), 4000.0  # a texel, and its radiance

SILVER = Material(name="mirror", roughness=0.15, metallic=1.0, metal="Ag")
COPPER = Material(name="copper", roughness=0.5, metallic=1.0, metal="Cu")
WHITE = Material(name="white", albedo=(0.8, 0.8, 0.8), roughness=0.8, metallic=0.0)
RED = Material(name="red", albedo=(0.6, 0.12, 0.05), roughness=0.4, metallic=0.0)


def directions(rows: int, columns: int) -> np.ndarray:
    """The unit direction of each texel of a lat-long map, (rows, columns, 3)."""
    theta = np.pi * np.arange(rows)[:, None] / (rows - 1)
    phi = 2 * np.pi * (np.arange(columns) + 0.5) / columns
    height = np.broadcast_to(np.cos(theta), (rows, columns))
    return np.stack([np.sin(theta) * np.sin(phi), np.sin(theta) * np.cos(phi), height], axis=-1)


def coded() -> np.ndarray:
    """A radiance map (h, w, 3) whose colours tell directions apart, without any symmetry."""
    x, y, z = np.moveaxis(directions(ROWS, COLUMNS), -1, 0)
    light = np.stack([0.5 + 0.45 * x, 0.5 + 0.45 * y, 0.5 + 0.45 * z], axis=-1)
    for at, colour in (((0.7, -0.6, 0.4), (4, 3, 1)), ((-0.8, -0.5, 0.1), (0.5, 2, 4))):
        towards = np.array(at) / np.linalg.norm(at)
        cosine = x * towards[0] + y * towards[1] + z * towards[2]
        light += np.exp(60 * (cosine - 1))[..., None] * np.array(colour)
    return light


def furnace() -> np.ndarray:
    """Half of white everywhere."""
    return np.full((ROWS, COLUMNS, 3), 0.5)


def one_texel() -> np.ndarray:
    """A faint sky with a sun of one texel."""
    light = np.full((ROWS, COLUMNS, 3), 0.05)
    light[SUN_AT] = SUN
    return light


def low_poly(folder: Path) -> str:
    """A ball of 80 triangles with the normals of a smooth one; its path."""
    ball = trimesh.creation.icosphere(subdivisions=1)
    return write_mesh(folder / "ball.ply", ball.vertices, ball.faces, ball.vertices)


def write_mesh(path: Path, vertices: np.ndarray, faces: np.ndarray, normals: np.ndarray) -> str:
    """Write a PLY with normals; its absolute path."""
    mesh = trimesh.Trimesh(vertices, faces, vertex_normals=normals, process=False)
    path.write_bytes(mesh.export(file_type="ply", vertex_normal=True))
    return str(path.absolute())


def write_light(path: Path, radiance: np.ndarray) -> Path:
    """Write a radiance map (h, w, 3); its absolute path."""
    write_exr(path, np.ascontiguousarray(radiance, np.float32), ["R", "G", "B"])
    return path.absolute()


# What honest renderers differ by, as RMS of log light: other models and filters of the same BRDF in
# the first three; prefiltered maps smear or lose the flanks of a small sun's highlight.
SOUND = {"mirror": 0.06, "normals": 0.12, "furnace": 0.12, "sun": 0.8}

CASES: dict[str, tuple[str, Callable[[], np.ndarray], tuple[tuple[str, Material], ...]]] = {
    "mirror": ("what a mirror ball shows of a sky of many colours", coded, (("sphere", SILVER),)),
    "normals": ("a ball of few triangles and smooth normals", coded, (("low poly", SILVER),)),
    "furnace": (
        "matt and metal balls in even light",
        furnace,
        (("sphere", WHITE), ("sphere", COPPER)),
    ),
    "sun": ("highlights of a sun of one texel", one_texel, (("sphere", COPPER), ("sphere", RED))),
}
PLACES = ((-0.25, 0.0, 0.3), (1.0, 0.5, -0.35))
SCALES = (0.75, 0.55)


def doctor_cases(folder: Path) -> dict[str, Case]:
    """The cases by name, with their files in a folder."""
    meshes = {"sphere": "sphere", "low poly": low_poly(folder)}
    made = {}
    for name, (_, light, things) in CASES.items():
        path = write_light(folder / f"{name}.exr", light())
        made[name] = Case(
            id=f"doctor.{name}",
            scene="doctor",
            environment=Environment(name=name, path=path),
            camera=CAMERA,
            width=SIZE[0],
            height=SIZE[1],
            objects=tuple(
                Object(
                    name=material.name,
                    mesh=meshes[mesh],
                    material=material,
                    position=place,
                    scale=scale,
                )
                for (mesh, material), place, scale in zip(things, PLACES, SCALES, strict=False)
            ),
        )
    return made
