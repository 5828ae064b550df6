"""The paper's irradiance map: 16x16 texels, lat-long, read with bilinear interpolation."""

import moderngl

from renderer.context import context
from renderer.program import bind_maps, fill, program, set_uniforms
from renderer.targets import release

SIZE = (16, 16)
SUMMED_WIDTH = 256  # the cosine is so smooth that finer levels of the environment add nothing


def make(radiance: moderngl.Texture) -> dict[str, moderngl.Texture]:
    """Irradiance E(n) as a float32 RGBA texture."""
    gl = context()
    texture = gl.texture(SIZE, 4, dtype="f4")
    texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
    texture.repeat_x, texture.repeat_y = True, False
    level = max(0, (radiance.width // SUMMED_WIDTH).bit_length() - 1)
    shader = program("fullscreen.vert", "irradiance.frag")
    set_uniforms(shader, level=level)
    bind_maps(shader, {"radiance_map": radiance})
    target = gl.framebuffer([texture])
    fill(target, shader)
    release(target)
    return {"irradiance_map": texture}
