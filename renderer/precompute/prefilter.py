"""The prefiltered environment: one mip level per roughness, for GGX and for Beckmann."""

from collections.abc import Collection

import moderngl

from renderer.context import context
from renderer.program import bind_maps, fill, program, set_uniforms
from renderer.targets import release
from scenes.schema import ALPHA_MIN

SIZE = (512, 256)
LEVELS = 6  # roughness 0, .2, .4, .6, .8, 1
SAMPLES = 1024


LOBES = {"prefiltered_ggx": "D_GGX", "prefiltered_beckmann": "D_BECKMANN"}  # as in the shader


def make(radiance: moderngl.Texture, names: Collection[str]) -> dict[str, moderngl.Texture]:
    """The named lobes as float32 RGBA textures: rgb weighted radiance, a the sum of weights."""
    gl = context()
    wanted = {name: lobe for name, lobe in LOBES.items() if name in names}
    shader = program("fullscreen.vert", "prefilter.frag", frozenset(wanted.values()))
    made = {}
    for name in wanted:
        made[name] = gl.texture(SIZE, 4, dtype="f4")
        made[name].build_mipmaps(max_level=LEVELS - 1)
        made[name].filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
        made[name].repeat_x, made[name].repeat_y = True, False
    for level in range(LEVELS):
        size = (SIZE[0] >> level, SIZE[1] >> level)
        targets = [gl.texture(size, 4, dtype="f4") for _ in made]
        framebuffer = gl.framebuffer(targets)
        bind_maps(shader, {"radiance_map": radiance})
        # A mirror needs no samples: alpha at its floor sees one filtered texel.
        count = SAMPLES if level else 1
        alpha = max((level / (LEVELS - 1)) ** 2, ALPHA_MIN)
        set_uniforms(shader, alpha=alpha, count=count, size=size)
        fill(framebuffer, shader)
        for texture, target in zip(made.values(), targets, strict=True):
            texture.write(target.read(), level=level)
        release(framebuffer, *targets)
    return made
