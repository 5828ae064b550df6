"""The paper's irradiance map: 16x16 texels, lat-long, read with bilinear interpolation."""

from collections.abc import Collection

import moderngl

from renderer.context import context
from renderer.program import bind_maps, fill, program, set_uniforms
from renderer.targets import release

# The fine one's texels are a 16th as large, and its interpolation errs a 16th as much.
SIZES = {"irradiance_map": (16, 16), "irradiance_map_fine": (64, 64)}
# The cosine is so smooth that finer levels of the environment add nothing; and Mesa's llvmpipe ends
# the loops of a shader, silently, after 65,535 turns in all.
MOST_CELLS = 60_000
FEWEST = (128, 64)  # columns and rows: of a coarser map its interpolation is summed


def make(radiance: moderngl.Texture, names: Collection[str]) -> dict[str, moderngl.Texture]:
    """Irradiance E(n) as float32 RGBA textures."""
    return {name: _made(radiance, SIZES[name]) for name in names}


def _made(radiance: moderngl.Texture, size: tuple[int, int]) -> moderngl.Texture:
    gl = context()
    texture = gl.texture(size, 4, dtype="f4")
    texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
    texture.repeat_x, texture.repeat_y = True, False
    level = _summed_level(radiance.width, radiance.height)
    shader = program("fullscreen.vert", "irradiance.frag")
    set_uniforms(shader, level=level, fewest=FEWEST)
    bind_maps(shader, {"radiance_map": radiance})
    target = gl.framebuffer([texture])
    fill(target, shader)
    release(target)
    return texture


def _summed_level(width: int, height: int) -> int:
    """The finest level of a map that has at most MOST_CELLS cells to sum over."""
    level = 0
    while max(width >> level, FEWEST[0]) * max(height >> level, FEWEST[1]) > MOST_CELLS:
        level += 1
    return level
