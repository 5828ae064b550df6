"""The light that a scene's surfaces send one another, bounce by bounce."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from time import perf_counter
from typing import Any

import moderngl

from renderer.context import context
from renderer.program import Maps, bind_maps, fill, program, set_uniforms
from renderer.targets import release
from renderer.transport.placed import ROW
from renderer.transport.scene import TOGETHER, SceneGeometry
from renderer.transport.visibility import WITNESSES

BOUNCES = 4  # what each errs is dimmed by all later ones: the last alone is exact
SHIFT = TOGETHER.bit_length() - 1


@dataclass(frozen=True, eq=False)
class Exchanged:
    """`irradiance` of each vertex and, packed, `local_radiance` of each sight, row by row; seconds
    taken."""

    maps: Maps
    seconds: float


def exchange(
    geometry: SceneGeometry,
    uniforms: dict[str, Any],
    maps: Maps,
    defines: frozenset[str],
    finely: Sequence[bool],
) -> Exchanged:
    """Send light from surface to surface.

    Args:
        uniforms, maps: of the environment and the materials.
        defines: the features that any of the materials needs.
        finely: whether each object looks into its surroundings through lobes so narrow that in the
            last bounce all witnesses are asked, and lights shaded apart.
    """
    start, gl = perf_counter(), context()
    maps = maps | geometry.maps
    sights = geometry.first_sight[-1]
    direct, *both = (_texture(geometry.vertices) for _ in range(3))
    coarse = [_packed(sights // TOGETHER) for _ in range(2)]
    gl.enable_only(moderngl.NOTHING)
    once = program("fullscreen.vert", "vertex_direct.frag", defines)
    _fill(direct, once, uniforms, maps)
    gathering = program("fullscreen.vert", "vertex_irradiance.frag", defines)
    sending = program("fullscreen.vert", "local_radiance.frag", defines)
    now = {"direct": direct, "local_radiance": coarse[0]}
    _clear(coarse[0])
    told = uniforms | {"sight_shift": SHIFT}
    together = {"sight_range": (0, sights // TOGETHER), "made_shift": SHIFT, "asked": 1}
    for bounce in range(BOUNCES):
        side = bounce % 2
        _fill(both[side], gathering, told, maps | now)
        now["irradiance"] = both[side]
        if bounce < BOUNCES - 1:
            _fill(coarse[1 - side], sending, told | together, maps | now)
            now["local_radiance"] = coarse[1 - side]
    made = {"irradiance": now["irradiance"], "local_radiance": _packed(sights)}
    lit = program("fullscreen.vert", "local_radiance.frag", defines | {"LIT_HITS"})
    for fine, (first, end) in zip(finely, pairwise(geometry.first_sight), strict=True):
        own = told | {"sight_range": (first, end), "asked": WITNESSES if fine else 1}
        shader = lit if fine and "LIGHTS" in defines else sending
        _fill(made["local_radiance"], shader, own | {"made_shift": 0}, maps | now, first, end)
    for texture in {direct, *both, *coarse} - set(made.values()):
        texture.release()
    gl.finish()
    return Exchanged(made, perf_counter() - start)


def _texture(count: int) -> moderngl.Texture:
    return _rows(count, 4, "f4")


def _packed(count: int) -> moderngl.Texture:
    """As rgbe.glsl packs colours."""
    return _rows(count, 1, "u4")


def _rows(count: int, components: int, dtype: str) -> moderngl.Texture:
    size = ROW, max(-(-count // ROW), 1)
    texture = context().texture(size, components, dtype=dtype)
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    return texture


def _clear(texture: moderngl.Texture) -> None:
    target = context().framebuffer([texture])
    target.clear()
    release(target)


def _fill(
    texture: moderngl.Texture,
    shader: moderngl.Program,
    uniforms: dict[str, Any],
    maps: Maps,
    first: int = 0,
    end: int | None = None,
) -> None:
    """Run a shader over a texture, or the rows that hold some of its elements."""
    target = context().framebuffer([texture])
    set_uniforms(shader, **uniforms)
    bind_maps(shader, maps)
    last = texture.height if end is None else -(-end // ROW)
    fill(target, shader, (0, first // ROW, ROW, last - first // ROW))
    release(target)
