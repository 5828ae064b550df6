"""The environment blurred by round kernels, one size a level, without the lights it is too coarse for."""

from collections.abc import Collection

import moderngl
import numpy as np

from renderer.context import context
from renderer.precompute.lights import MOST, Lights, extract
from renderer.precompute.radiance import as_texture
from renderer.program import bind_maps, fill, program, set_uniforms
from renderer.targets import release

import os
BLUR = frozenset(os.environ.get('BLUR','SPREAD 0.25').split(',')) - {''}
TAPS = 96
WIDEST = 4.0 * np.pi
# A light is left to the samples while their share of directions is below this part of its own.
LIGHT_SHARE = float(os.environ.get('SHARE','.5'))


def make(radiance: moderngl.Texture, names: Collection[str]) -> dict[str, moderngl.Texture]:
    """The blurred environment, and its lights as two rows of texels."""
    width, height = radiance.size
    pixels = np.frombuffer(radiance.read(), np.float32).reshape(height, width, 4)[..., :3]
    lights = extract(pixels)
    finest = finest_levels(lights.solid_angle, width)
    return {"lights_map": _light_texture(lights, finest), "blurred_map": _blurred(radiance, pixels, lights, finest)}


def finest_levels(solid_angle: np.ndarray, width: int) -> np.ndarray:
    """The level from which on each light is gone; at the one below it is still whole."""
    level = 0.5 * np.log2(np.maximum(LIGHT_SHARE * solid_angle, 1e-30) / texel(width))
    return np.maximum(np.ceil(level), 1).astype(int)


def texel(width: int) -> float:
    """The solid angle of a texel on the equator: what level 0 resolves."""
    return (2 * np.pi / width) ** 2


def _light_texture(lights: Lights, finest: np.ndarray) -> moderngl.Texture:
    count = max(len(finest), 1)
    texels = np.zeros((2, count, 4), np.float32)
    if len(finest):
        texels[0, :, :3], texels[0, :, 3] = lights.directions, finest
        texels[1, :, :3], texels[1, :, 3] = lights.irradiance, lights.solid_angle
    texture = context().texture((count, 2), 4, texels.tobytes(), dtype="f4")
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    texture.extra = len(finest)
    return texture


def _blurred(radiance, pixels, lights, finest) -> moderngl.Texture:
    gl = context()
    made = gl.texture(radiance.size, 4, dtype="f4")
    made.build_mipmaps()
    made.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    made.repeat_x, made.repeat_y = True, False
    made.write(radiance.read(), level=0)
    shader = program("fullscreen.vert", "blurred.frag", BLUR)
    source, left = radiance, len(finest)
    levels = int(np.log2(max(radiance.size)))
    for level in range(1, levels + 1):
        stay = np.append(finest > level, False)  # of label -1
        if stay.sum() != left:
            left = stay.sum()
            source = as_texture(pixels - lights.excess * ~stay[lights.label][..., None] * (lights.label >= 0)[..., None])
        size = tuple(max(n >> level, 1) for n in radiance.size)
        target = gl.texture(size, 4, dtype="f4")
        framebuffer = gl.framebuffer([target])
        bind_maps(shader, {"radiance_map": source})
        set_uniforms(shader, taps=TAPS, share=texel(radiance.width) * 4.0**level, size=size)
        fill(framebuffer, shader)
        made.write(target.read(), level=level)
        release(framebuffer, target)
    return made


def light_uniforms(texture: moderngl.Texture, turn: float) -> dict:
    """A map of lights as uniforms, in an environment turned by a fraction of a full turn."""
    texels = np.frombuffer(texture.read(), np.float32).reshape(2, -1, 4)
    count = texels.shape[1]
    rows = np.zeros((2, MOST, 4), np.float32)
    rows[:, :count] = texels
    x, y = texels[0, :, 0], texels[0, :, 1]
    cos, sin = np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)
    rows[0, :count, 0], rows[0, :count, 1] = cos * x - sin * y, sin * x + cos * y
    return {
        "light_count": count,
        "light_towards": rows[0].tobytes(),
        "light_irradiance": rows[1].tobytes(),
    }
