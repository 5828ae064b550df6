"""The environment blurred by round kernels, one size a level, and the lights taken out of it.

A mip of a lat-long map is a box that shrinks towards the poles; between its texels lies a kink. The
levels here are smooth and equally round everywhere, so that a few filtered samples add up to a
smooth lobe. From its own level on a light is not in them but is shaded as a point: see `lights`.
"""

from collections.abc import Collection
from functools import lru_cache
from typing import Any

import moderngl
import numpy as np

from renderer.context import context
from renderer.precompute.lights import MOST, Lights, extract
from renderer.precompute.radiance import as_texture
from renderer.program import bind_maps, fill, program, set_uniforms
from renderer.targets import release

TAPS = 96
# A sample shows a light while it stands for less than this part of the light's solid angle.
LEFT_TO_SAMPLES = 0.5


def make(radiance: moderngl.Texture, _names: Collection[str]) -> dict[str, moderngl.Texture]:
    """The environment without lights, level by level, as a float32 RGBA texture; and the lights.

    Level l is for samples that stand for 4^l texels at the equator; level 0 is the environment.
    `lights_map` has a column a light, or one that is black if there is none. Row 0: direction in
    an environment that is not turned, and the level from which on the light is gone (at the one
    below it is whole). Row 1: irradiance of a surface that faces it.
    """
    return dict(zip(("lights_map", "blurred_map"), _made(radiance), strict=True))


@lru_cache(maxsize=4)
def _made(radiance: moderngl.Texture) -> tuple[moderngl.Texture, moderngl.Texture]:
    width, height = radiance.size
    pixels = np.frombuffer(radiance.read(), np.float32).reshape(height, width, 4)[..., :3]
    lights = extract(pixels)
    gone = levels_of(lights, width)
    return _stored(lights, gone), _blurred(radiance, lights, gone)


def levels_of(lights: Lights, width: int) -> np.ndarray:
    """The level from which on each light is gone from a map of `width` columns, (n,) int."""
    texels = lights.solid_angle / _share(0, width)
    return np.maximum(np.ceil(0.5 * np.log2(LEFT_TO_SAMPLES * texels)), 1).astype(int)


def light_uniforms(lights_map: moderngl.Texture, turn: float) -> dict[str, Any]:
    """The lights as uniforms, in an environment turned by a fraction of a full turn; {} if none."""
    texels = np.frombuffer(lights_map.read(), np.float32).reshape(2, -1, 4)
    if not texels[1].any():
        return {}
    texels = texels[:, np.argsort(-texels[1].sum(axis=1))]  # the brightest first
    count = texels.shape[1]
    rows = np.zeros((2, MOST, 4), np.float32)
    rows[:, :count] = texels
    x, y = texels[0, :, 0], texels[0, :, 1]
    cosine, sine = np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)
    rows[0, :count, 0], rows[0, :count, 1] = cosine * x - sine * y, sine * x + cosine * y
    return {
        "light_count": count,
        "light_towards": rows[0].tobytes(),
        "light_irradiance": rows[1].tobytes(),
    }


def _share(level: int, width: int) -> float:
    """The solid angle that a sample of a level stands for."""
    return (2 * np.pi / width) ** 2 * 4.0**level


def _stored(lights: Lights, gone: np.ndarray) -> moderngl.Texture:
    texels = np.zeros((2, max(len(gone), 1), 4), np.float32)
    texels[0, : len(gone), :3], texels[0, : len(gone), 3] = lights.directions, gone
    texels[1, : len(gone), :3] = lights.irradiance
    return context().texture(texels.shape[1::-1], 4, texels.tobytes(), dtype="f4")


def _blurred(radiance: moderngl.Texture, lights: Lights, gone: np.ndarray) -> moderngl.Texture:
    gl = context()
    made = gl.texture(radiance.size, 4, radiance.read(), dtype="f4")
    made.build_mipmaps()  # allocates the levels that are overwritten here
    made.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    made.repeat_x, made.repeat_y = True, False
    shader = program("fullscreen.vert", "blurred.frag")
    source = radiance
    for level in range(1, max(radiance.size).bit_length()):
        if (gone == level).any():
            source = as_texture(lights.rest(gone <= level))
        size = tuple(max(n >> level, 1) for n in radiance.size)
        target = gl.texture(size, 4, dtype="f4")
        framebuffer = gl.framebuffer([target])
        bind_maps(shader, {"radiance_map": source})
        set_uniforms(shader, taps=TAPS, share=_share(level, radiance.width))
        fill(framebuffer, shader)
        made.write(target.read(), level=level)
        release(framebuffer, target)
    return made
