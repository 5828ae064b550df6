"""A material's pictures as textures whose further levels hold means, of values or of their powers.

Between texel centres a picture is bilinear, and it is that surface whose means are taken: a texel's
own mean is by Gauss' rule over its four quarters.
"""

import itertools
from collections.abc import Callable
from functools import cache

import moderngl
import numpy as np

from renderer.context import context
from renderer.precompute.radiance import averaged, overlap
from renderer.program import Maps
from scenes.schema import Material, Object
from scenes.surface import surface

NODES = 3  # of Gauss' rule for a quarter: exact to the fifth power


def make(obj: Object) -> Maps:
    """The textures of an object's pictures, by their names in GLSL."""
    maps: Maps = {}
    textures = surface(obj).textures
    for name, texels in textures.items():
        paired = "metallic" in textures and textures["metallic"].shape[:2] == texels.shape[:2]
        metallic = textures["metallic"] if paired else None
        found = _levels(name, texels, obj.material, metallic)
        maps |= {k: _texture(_bytes(levels)) for k, levels in found}
    return maps


def _levels(
    name: str, texels: np.ndarray, material: Material, metallic: np.ndarray | None
) -> list[tuple[str, list[np.ndarray]]]:
    """The textures of one picture; `metallic` is the map of that name if it is of the same size."""
    if name == "normal":
        return [
            ("normal_map", _pyramid(texels, texels)),
            ("slopes_map", _pyramid(_products(texels), texels, _products)),
        ]
    if name == "roughness":
        return [("roughness_map", _roughness(texels, material, metallic))]
    if name == "metallic":
        both = _pyramid(np.repeat(texels, 2, axis=2), texels, lambda m: np.dstack([m, m**2]))
        return [("metallic_map", both)]
    if name == "albedo" and metallic is not None:
        both = np.dstack([texels, 1 - material.metallic * metallic])
        return [("albedo_map", _pyramid(texels, both, lambda b: b[..., :3] * b[..., 3:]))]
    return [(f"{name}_map", _pyramid(texels, texels))]


def _roughness(
    texels: np.ndarray, material: Material, metallic: np.ndarray | None
) -> list[np.ndarray]:
    """r, and the means of r⁴ in the second channel, by the light that each texel reflects."""

    def both(r: np.ndarray) -> np.ndarray:
        return np.dstack([r, r**4])

    first = np.repeat(texels, 2, axis=2)
    if metallic is None:
        return _pyramid(first, texels, both)
    dielectric = float(np.mean(material.f0.f0))
    more = material.metallic * (float(np.mean(material.metal.f0)) - dielectric)
    pair = np.dstack([texels, dielectric + more * metallic])
    levels = _pyramid(first, pair, lambda p: np.dstack([both(p[..., :1]) * p[..., 1:], p[..., 1:]]))
    return [first, *(level[..., :2] / np.maximum(level[..., 2:], 1e-9) for level in levels[1:])]


def paired(obj: Object) -> bool:
    """Whether the means of an object's albedo are of its product with 1 - metallic."""
    textures = surface(obj).textures
    both = [textures[name].shape[:2] for name in ("albedo", "metallic") if name in textures]
    return len(both) == 2 and both[0] == both[1]


def _products(slopes: np.ndarray) -> np.ndarray:
    return np.dstack([slopes**2, slopes[..., :1] * slopes[..., 1:]])


def _pyramid(
    first: np.ndarray,
    texels: np.ndarray,
    of: Callable[[np.ndarray], np.ndarray] = lambda values: values,
) -> list[np.ndarray]:
    """Level 0 as it is given; then the means of a function of the picture, each half as large."""
    levels, mean = [first], _cell_means(texels, of)
    while max(mean.shape[:2]) > 1:
        for axis in (0, 1):
            size = mean.shape[axis]
            halved = averaged(overlap(size, max(size // 2, 1)), mean.swapaxes(0, axis))
            mean = halved.swapaxes(0, axis)
        levels.append(mean)
    return [np.ascontiguousarray(level, np.float32) for level in levels]


def _cell_means(texels: np.ndarray, of: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """The mean over each texel of a function of the bilinear picture, (H, W, k) float64."""
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    places = np.concatenate([-(nodes + 1) / 4, (nodes + 1) / 4])
    shares = np.concatenate([weights, weights]) / 4
    texels = texels.astype(float)
    rows = [_moved(texels, place, 0) for place in places]
    pairs = itertools.product(zip(rows, shares, strict=True), zip(places, shares, strict=True))
    return sum(of(_moved(row, place, 1)) * (a * b) for (row, a), (place, b) in pairs)


def _moved(texels: np.ndarray, by: float, axis: int) -> np.ndarray:
    """The picture at places `by` texels further on, up to one either way."""
    return (1 - abs(by)) * texels + abs(by) * np.roll(texels, -1 if by > 0 else 1, axis)


def _bytes(levels: list[np.ndarray]) -> tuple[tuple[tuple[int, ...], bytes], ...]:
    return tuple((level.shape, np.float32(level).tobytes()) for level in levels)


@cache  # a picture that several materials or cases share lies on the GPU once
def _texture(levels: tuple[tuple[tuple[int, ...], bytes], ...]) -> moderngl.Texture:
    (height, width, parts), _ = levels[0]
    texture = context().texture((width, height), parts, dtype="f4")
    if len(levels) > 1:
        texture.build_mipmaps()  # allocates the levels that are overwritten here
    for number, (_, values) in enumerate(levels):
        texture.write(values, level=number)
    texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    texture.repeat_x = texture.repeat_y = True
    return texture
