"""What hard cases are made of: maps, meshes and materials, written into a folder."""

import hashlib
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
import trimesh

from scenes.schema import Camera, Case, Environment, Material, Model, Object

SIZE = (48, 32)
AHEAD = Camera(origin=(0.0, -4.0, 0.0), target=(0.0, 0.0, 0.0), fov=40)

MIRROR = Material(roughness=0.0, metallic=1.0, metal="Ag")
COPPER = Material(roughness=0.4, metallic=1.0, metal="Cu", weight=0.5)
PLASTIC = Material(albedo=(0.6, 0.3, 0.05), roughness=0.6, metallic=0.0, weight=0.5)
WHITE = Material(roughness=0.5, metallic=1.0, metal=(1.0, 1.0, 1.0), weight=0.5)

Thing = tuple[str, Material, dict[str, Any]]  # mesh, material, further fields of Object
# Surfaces of three kinds in one picture, each before a part of the light.
BALLS: tuple[Thing, ...] = (
    ("sphere", MIRROR, {"position": (-0.8, 0.0, 0.2), "scale": 0.5}),
    ("sphere", COPPER, {"position": (0.2, -0.5, -0.2), "scale": 0.6}),
    ("sphere", PLASTIC, {"position": (0.9, 0.5, 0.3), "scale": 0.7}),
)


def lit(path: Path, *things: Thing, rotation: float = 0.0, **fields: Any) -> Case:
    """A case from its radiance map and its objects; `fields` replace others of the case."""
    size = fields.pop("size", SIZE)
    return Case(
        id="hard",
        scene="hard",
        environment=Environment(name="hard", path=path.absolute(), rotation=rotation),
        camera=fields.pop("camera", AHEAD),
        width=size[0],
        height=size[1],
        model=fields.pop("model", Model()),
        objects=tuple(
            Object(name=f"object{i}", mesh=mesh, material=material, **more)
            for i, (mesh, material, more) in enumerate(things)
        ),
    )


def write_map(folder: Path, radiance: np.ndarray) -> Path:
    """Write a radiance map (H, W, 3) as float32 EXR, named by its content as all these files."""
    pixels = np.ascontiguousarray(radiance, np.float32)
    path = folder / f"{_digest(repr(pixels.shape).encode() + pixels.tobytes())}.exr"
    if path.is_file():
        return path
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, oiio.FLOAT)
    image = oiio.ImageOutput.create(str(path))
    if not (image.open(str(path), spec) and image.write_image(pixels) and image.close()):
        raise OSError(image.geterror())
    return path


def constant(folder: Path, radiance: float, size: tuple[int, int] = (16, 32)) -> Path:
    """A map of one radiance; `size` is rows and columns."""
    return write_map(folder, np.full((*size, 3), radiance))


def sky(folder: Path, factor: float = 1.0, mirrored: bool = False) -> Path:
    """An ordinary map: coloured, uneven, with nothing that is hard about it."""
    pixels = factor * np.random.default_rng(0).uniform(0.5, 1.5, (16, 32, 3))
    pixels = pixels[:, ::-1] if mirrored else pixels  # x to -x: the azimuth changes its sign
    return write_map(folder, pixels)


def under_sky(*things: Thing, **fields: Any) -> Callable[[Path], Case]:
    """Objects under the ordinary map."""
    return lambda folder: lit(sky(folder), *things, **fields)


def write_ply(
    folder: Path,
    vertices: Iterable[Iterable[float]],
    faces: Iterable[Iterable[int]],
    normals: Iterable[Iterable[float]] | None = None,
) -> str:
    """Write triangles as they are, NaN too, in double precision; return the path."""
    columns = [np.asarray(list(vertices), float)]
    names = ["x", "y", "z"]
    if normals is not None:
        columns.append(np.asarray(list(normals), float))
        names += ["nx", "ny", "nz"]
    table, faces = np.hstack(columns), np.asarray(list(faces), int)
    lines = ["ply", "format ascii 1.0", f"element vertex {len(table)}"]
    lines += [f"property double {name}" for name in names]
    lines += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(map(repr, row)) for row in table.tolist()]
    lines += ["3 " + " ".join(map(str, face)) for face in faces.tolist()]
    text = "\n".join(lines) + "\n"
    path = folder / f"{_digest(text.encode())}.ply"
    path.write_text(text)
    return str(path.absolute())


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:16]


def lump() -> tuple[np.ndarray, np.ndarray]:
    """A closed mesh without symmetry: vertices (n, 3) about the origin and faces (m, 3)."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    shift = 0.25 * np.sin(3 * ball.vertices[:, [1, 2, 0]] + [0.0, 0.5, 1.0])
    return np.float32(ball.vertices * (0.8 + shift)).astype(float), np.asarray(ball.faces)
