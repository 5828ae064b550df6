"""The paper's irradiance map: 16x16 texels, lat-long, read with bilinear interpolation."""

import moderngl

from renderer.context import context
from renderer.program import bind_maps, fill, program, set_uniforms
from renderer.targets import release

SIZE = (16, 16)
FINE_SIZE = (64, 64)
SUMMED_WIDTH = 256  # the cosine is so smooth that finer levels of the environment add nothing


def make(radiance: moderngl.Texture) -> dict[str, moderngl.Texture]:
    """Irradiance E(n) as a float32 RGBA texture."""
    return {"irradiance_map": _made(radiance, SIZE)}


def make_fine(radiance: moderngl.Texture) -> dict[str, moderngl.Texture]:
    """The same in texels a 16th as large, whose interpolation errs a 16th as much."""
    return {"irradiance_map_fine": _made(radiance, FINE_SIZE)}


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
