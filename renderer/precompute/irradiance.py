"""The paper's irradiance map: 16x16 texels, lat-long, read with bilinear interpolation."""

from collections.abc import Collection

import moderngl

from renderer.context import context
from renderer.program import bind_maps, fill, program, set_uniforms
from renderer.targets import release

# The fine one's texels are a 16th as large, and its interpolation errs a 16th as much.
SIZES = {"irradiance_map": (16, 16), "irradiance_map_fine": (64, 64)}
SUMMED_WIDTH = 256  # the cosine is so smooth that finer levels of the environment add nothing


def make(radiance: moderngl.Texture, names: Collection[str]) -> dict[str, moderngl.Texture]:
    """Irradiance E(n) as float32 RGBA textures."""
    return {name: _made(radiance, SIZES[name]) for name in names}


def _made(radiance: moderngl.Texture, size: tuple[int, int]) -> moderngl.Texture:
    gl = context()
    texture = gl.texture(size, 4, dtype="f4")
    texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
    texture.repeat_x, texture.repeat_y = True, False
    level = max(0, (radiance.width // SUMMED_WIDTH).bit_length() - 1)
    shader = program("fullscreen.vert", "irradiance.frag")
    set_uniforms(shader, level=level)
    bind_maps(shader, {"radiance_map": radiance})
    target = gl.framebuffer([texture])
    fill(target, shader)
    release(target)
    return texture
