"""What the checks of conformance share: what is allowed, and how the GPU is read."""

from functools import lru_cache

import moderngl
import numpy as np

from renderer.context import context
from renderer.precompute import BASE
from renderer.program import fill
from renderer.targets import release
from reports.conformance.result import Conformance
from scenes.schema import Material

# What a correct renderer is off by, measured over the suites that come with the code, and some
# room. Maps are held as root mean squares over the places that are looked at, relative to theirs.
ALLOWED = {
    "light": 2e-3,
    "levels of the light": 1e-5,
    "surfaces": 1e-6,
    "sizes of maps": 0.0,
    "irradiance map": 5e-3,
    "prefiltered maps": 0.02,
    "prefiltered weights": 0.01,
    "mirror's map": 0.03,
    "Beckmann over GGX": 1e-4,
    "tables": 0.01,
    "split sum": 5e-3,
    "power of lights": 1e-4,
    "blurred levels": 0.03,
    "filtered light": 0.03,
    "lobes": 0.05,
    "better split sum": 1e-3,
    "samples": 1e-4,
    "densities": 1e-4,
    "horizon": 0.0,
    "normals": 1e-5,
    "edges": 0.75,  # of what no filter is off; four coverage samples leave .1 to .4
}
FIRST_UNIT = 8  # texture units below are the probe's own
MATERIAL = "Material(albedo, f0, alpha, weight_d, weight_g)"
UNIFORMS = "uniform vec3 albedo, f0; uniform float alpha; uniform vec2 weight_d, weight_g;"


def measured(name: str, off: float, place: str) -> Conformance:
    return Conformance(name, float(off), ALLOWED[name], place)


def relative(ours: np.ndarray, theirs: np.ndarray) -> float:
    """The root mean square difference, relative to that of `theirs`."""
    size = np.sqrt((theirs.astype(float) ** 2).mean())
    return float(np.sqrt(((ours - theirs.astype(float)) ** 2).mean()) / max(size, 1e-30))


@lru_cache(maxsize=64)
def texels_of(texture: moderngl.Texture, level: int = 0) -> np.ndarray:
    """A float32 RGBA texture's level, (H, W, 4)."""
    size = max(texture.width >> level, 1), max(texture.height >> level, 1)
    return np.frombuffer(texture.read(level=level), np.float32).reshape(size[1], size[0], 4)


def levels_of(maps: dict) -> list[np.ndarray]:
    """Every level of the radiance map, (H, W, 3) each."""
    count = max(maps[BASE].width, maps[BASE].height).bit_length()
    return [texels_of(maps[BASE], level)[..., :3] for level in range(count)]


def filled(drawn: moderngl.Program | moderngl.VertexArray, size: tuple[int, int]) -> np.ndarray:
    """What a fragment program, or triangles, write into `size` (width, height) pixels.

    Returns:
        (n, 4), rows from the bottom.
    """
    target = context().framebuffer([context().texture(size, 4, dtype="f4")])
    if isinstance(drawn, moderngl.Program):
        fill(target, drawn)
    else:
        target.use()
        drawn.render()
    pixels = np.frombuffer(target.read(components=4, dtype="f4"), np.float32).reshape(-1, 4)
    release(target, *target.color_attachments)
    return pixels


def spread(count: int, seed: int) -> np.ndarray:
    """Unit directions (count, 3), the poles and both sides of the seam among them."""
    rng = np.random.default_rng(seed)
    z, phi = rng.uniform(-1, 1, count), rng.uniform(0, 2 * np.pi, count)
    s = np.sqrt(1 - z**2)
    some = np.stack([s * np.sin(phi), s * np.cos(phi), z], 1)
    some[:4] = [0, 0, 1], [0, 0, -1], [1e-3, 1, 0], [-1e-3, 1, 0]
    return some / np.linalg.norm(some, axis=1, keepdims=True)


def uniforms_of(material: Material) -> dict:
    return {
        "albedo": material.diffuse_albedo,
        "f0": material.specular_f0,
        "alpha": material.alpha,
        "weight_d": (material.weight, 1 - material.weight),
        "weight_g": (material.masking_weight, 1 - material.masking_weight),
    }
