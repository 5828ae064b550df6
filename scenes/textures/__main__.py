"""Draw the pictures beside this file, and the mesh that carries its material at its vertices."""

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import trimesh

HERE = Path(__file__).resolve().parent
SIZE = 256


def _noise(seed: int, finest: float, coarsest: float) -> np.ndarray:
    """Noise that repeats, of unit variance, with wavelengths in texels, (SIZE, SIZE)."""
    white = np.random.default_rng(seed).normal(size=(SIZE, SIZE))
    f = np.hypot(*np.meshgrid(np.fft.fftfreq(SIZE), np.fft.fftfreq(SIZE)))
    band = np.exp(-((f * finest) ** 2)) * (1 - np.exp(-((f * coarsest) ** 2)))
    made = np.fft.ifft2(np.fft.fft2(white) * band).real
    return made / made.std()


def _save(name: str, pixels: np.ndarray, depth: str) -> None:
    path = str(HERE / f"{name}.png")
    spec = oiio.ImageSpec(SIZE, SIZE, pixels.shape[2], depth)
    image = oiio.ImageOutput.create(path)
    image.open(path, spec)
    image.write_image(np.ascontiguousarray(pixels, np.float32))
    image.close()


def _pictures() -> None:
    bare = 1 / (1 + np.exp(-8 * (_noise(1, 12, 60) - 0.6)))[..., None]  # where paint is worn off
    shade = 1 + 0.12 * _noise(2, 3, 40)[..., None]
    paint, dust = np.array([0.72, 0.2, 0.13]), np.array([0.75, 0.75, 0.75])
    _save("worn_albedo", np.clip((1 - bare) * paint * shade + bare * dust, 0, 1), "uint8")
    _save("worn_metallic", bare, "uint8")
    rough = (1 - bare) * 0.62 + bare * 0.3 + 0.05 * _noise(3, 2, 20)[..., None]
    _save("worn_roughness", np.clip(rough, 0.05, 1), "uint8")
    height = 0.5 * _noise(4, 9, 40)
    up, across = (-(np.roll(height, -1, k) - np.roll(height, 1, k)) / 2 for k in (0, 1))
    slopes = np.dstack([across, -up, np.ones_like(height)])  # row 0 is on top, n.y points up
    _save(
        "hammered_normal",
        slopes / np.linalg.norm(slopes, axis=2, keepdims=True) / 2 + 0.5,
        "uint16",
    )


def _knot() -> None:
    """A trefoil knot whose roughness and share of GGX change along it."""
    along, around = 320, 40
    t = np.linspace(0, 2 * np.pi, along, endpoint=False)[:, None]
    middle = np.stack(
        [np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], axis=2
    )
    tangent = np.roll(middle, -1, 0) - np.roll(middle, 1, 0)
    tangent /= np.linalg.norm(tangent, axis=2, keepdims=True)
    side = np.cross(tangent, [0.0, 0, 1])
    side /= np.linalg.norm(side, axis=2, keepdims=True)
    phi = np.linspace(0, 2 * np.pi, around, endpoint=False)[None, :, None]
    normals = np.cos(phi) * side + np.sin(phi) * np.cross(side, tangent)
    points = middle + 0.62 * normals
    i, j = np.meshgrid(np.arange(along), np.arange(around), indexing="ij")
    a, b = i * around + j, i * around + (j + 1) % around
    c, d = (a + around) % (along * around), (b + around) % (along * around)
    faces = np.stack([np.stack([a, b, c], 2), np.stack([b, d, c], 2)], 2).reshape(-1, 3)
    whole = np.ones((1, around))
    mesh = trimesh.Trimesh(
        np.float32(points.reshape(-1, 3)),
        faces,
        vertex_normals=normals.reshape(-1, 3),
        process=False,
    )
    if mesh.volume < 0:
        mesh.faces = mesh.faces[:, ::-1]
    values = {"roughness": 0.6 + 0.4 * np.cos(3 * t), "weight": 0.5 + 0.5 * np.sin(2 * t)}
    for name, value in values.items():
        mesh.vertex_attributes[name] = np.float32(value * whole).reshape(-1)
    mesh.export(HERE.parent / "meshes" / "knot.ply", vertex_normal=True)


if __name__ == "__main__":
    _pictures()
    _knot()
