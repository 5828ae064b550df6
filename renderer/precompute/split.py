"""Maps and tables of `split`, and exact irradiance, by samples and lights as in `filtered`."""

from collections.abc import Collection
from functools import cache
from typing import Any

import moderngl

from renderer.context import context
from renderer.precompute import blurred
from renderer.program import bind_maps, fill, program, set_uniforms
from renderer.targets import release

Made = dict[str, moderngl.Texture]
LAYERS = 15  # alpha 1/128 to 1, each the root of 2 times the one before
LAYER_SIZE = (256, 128)
LOBE_SAMPLES = 128
TABLE_SIZE, TABLE_SAMPLES = (64, 64), 1024  # over n.v and roughness
IRRADIANCE_SIZE, IRRADIANCE_SAMPLES = (128, 65), 1024

LOBES = {"lobe_ggx": "D_GGX", "lobe_beckmann": "D_BECKMANN"}  # as in the shader


def make_lobes(radiance: moderngl.Texture, names: Collection[str]) -> Made:
    """Per lobe a float32 RGBA texture: rgb weighted radiance, a the sum of weights; n = v = r.

    Lat-long maps for one alpha each, one below the other.
    """
    wanted = {name: lobe for name, lobe in LOBES.items() if name in names}
    size = LAYER_SIZE[0], LAYER_SIZE[1] * LAYERS
    shader = program("fullscreen.vert", "lobe_map.frag", frozenset(wanted.values()))
    light = _light(radiance, shader)
    return _filled(wanted, size, shader, **light, layers=float(LAYERS), count=LOBE_SAMPLES)


def make_irradiance(radiance: moderngl.Texture, names: Collection[str]) -> Made:
    """E(n) as float32 RGBA lat-long textures, their rows from pole to pole.

    `irradiance_exact` is of the whole environment, `irradiance_sky` without its lights.
    """
    made = {}
    for name in names:
        shader = program("fullscreen.vert", f"{name}.frag")
        told = {"count": IRRADIANCE_SAMPLES, "rows": IRRADIANCE_SIZE[1]}
        made |= _filled([name], IRRADIANCE_SIZE, shader, **_light(radiance, shader), **told)
    return made


def make_tables(_radiance: moderngl.Texture, names: Collection[str]) -> Made:
    """Per lobe of D what is reflected, and whereto: see lobe_table.frag.

    x is n.v, y is roughness. The environment is not read: all share them.
    """
    made = {}
    for lobe in LOBES.values():
        made |= _tables(lobe)
    return {name: made[name] for name in names}


@cache
def _tables(lobe: str) -> Made:
    names = [f"{what}_{lobe.removeprefix('D_').lower()}" for what in ("albedo", "towards")]
    shader = program("fullscreen.vert", "lobe_table.frag", frozenset({lobe}))
    made = _filled(names, TABLE_SIZE, shader, count=TABLE_SAMPLES)
    for texture in made.values():
        texture.repeat_x = False
    return made


def _light(radiance: moderngl.Texture, shader: moderngl.Program) -> dict[str, Any]:
    """Bind the blurred environment to a shader; its lights as uniforms."""
    light = blurred.make(radiance, ())
    bind_maps(shader, {"radiance_map": radiance, "blurred_map": light["blurred_map"]})
    return {"light_count": 0} | blurred.light_uniforms(light["lights_map"], 0.0)


def _filled(
    names: Collection[str], size: tuple[int, int], shader: moderngl.Program, **uniforms: Any
) -> Made:
    """Textures of a size, written by a shader, one an output."""
    gl = context()
    made = {name: gl.texture(size, 4, dtype="f4") for name in names}
    for texture in made.values():
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        texture.repeat_x, texture.repeat_y = True, False
    set_uniforms(shader, **uniforms)
    framebuffer = gl.framebuffer(list(made.values()))
    fill(framebuffer, shader)
    release(framebuffer)
    return made
