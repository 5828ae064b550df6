"""Maps and tables of the technique `split`, made of filtered samples and of lights."""

from collections.abc import Collection
from functools import cache

import moderngl

from renderer.context import context
from renderer.precompute import blurred
from renderer.program import bind_maps, fill, program, set_uniforms
from renderer.targets import release

LAYERS = 8  # alpha 1/128, 1/64, ..., 1
LAYER_SIZE = (256, 128)
LOBE_SAMPLES = 64
TABLE_SIZE = (64, 64)
TABLE_SAMPLES = 1024
IRRADIANCE_SIZE = (64, 32)
IRRADIANCE_SAMPLES = 256

LOBES = {"lobe_ggx": "D_GGX", "lobe_beckmann": "D_BECKMANN"}  # as in the shader


def make_lobes(radiance: moderngl.Texture, names: Collection[str]) -> dict[str, moderngl.Texture]:
    wanted = {name: lobe for name, lobe in LOBES.items() if name in names}
    size = LAYER_SIZE[0], LAYER_SIZE[1] * LAYERS
    return dict(zip(wanted, _filled(size, len(wanted), "lobe_map.frag", frozenset(wanted.values()), radiance, layers=float(LAYERS), count=LOBE_SAMPLES), strict=True))


def make_irradiance(radiance: moderngl.Texture, _names: Collection[str]) -> dict[str, moderngl.Texture]:
    (made,) = _filled(IRRADIANCE_SIZE, 1, "irradiance_exact.frag", frozenset(), radiance, count=IRRADIANCE_SAMPLES)
    return {"irradiance_exact": made}


def make_ggx_tables(_radiance: moderngl.Texture, _names: Collection[str]) -> dict[str, moderngl.Texture]:
    return dict(zip(("albedo_ggx", "towards_ggx"), _tables("D_GGX"), strict=True))


def make_beckmann_tables(_radiance: moderngl.Texture, _names: Collection[str]) -> dict[str, moderngl.Texture]:
    return dict(zip(("albedo_beckmann", "towards_beckmann"), _tables("D_BECKMANN"), strict=True))


@cache
def _tables(lobe: str) -> list[moderngl.Texture]:
    made = _filled(TABLE_SIZE, 2, "lobe_table.frag", frozenset({lobe}), None, count=TABLE_SAMPLES)
    for t in made:
        t.repeat_x = False
    return made


def _filled(size, maps, fragment, defines, radiance, **uniforms) -> list[moderngl.Texture]:
    gl = context()
    made = [gl.texture(size, 4, dtype="f4") for _ in range(maps)]
    for texture in made:
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        texture.repeat_x, texture.repeat_y = True, False
    shader = program("fullscreen.vert", fragment, defines)
    if radiance:
        light = blurred.make(radiance, ())
        bind_maps(shader, {"radiance_map": radiance, "blurred_map": light["blurred_map"]})
        uniforms |= {"light_count": 0} | blurred.light_uniforms(light["lights_map"], 0.0)
    set_uniforms(shader, **uniforms)
    framebuffer = gl.framebuffer(made)
    fill(framebuffer, shader)
    release(framebuffer)
    return made
