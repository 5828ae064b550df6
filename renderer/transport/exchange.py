"""The light that a scene's surfaces send one another, bounce by bounce."""

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import moderngl

from renderer.context import context
from renderer.program import Maps, bind_maps, fill, program, set_uniforms
from renderer.targets import release
from renderer.transport.placed import ROW
from renderer.transport.scene import SceneGeometry

# How many witnesses are asked, bounce by bounce: what they err is dimmed by all later ones.
ASKED = (1, 1, 1, 3)


@dataclass(frozen=True, eq=False)
class Exchanged:
    """`irradiance` of each vertex and `local_radiance` of each sight, row by row; seconds taken."""

    maps: Maps
    seconds: float


def exchange(
    geometry: SceneGeometry, uniforms: dict[str, Any], maps: Maps, defines: frozenset[str]
) -> Exchanged:
    """Send light from surface to surface.

    Args:
        uniforms, maps: of the environment and the materials.
        defines: the features that any of the materials needs.
    """
    start, gl = perf_counter(), context()
    sides = {"irradiance": geometry.vertices, "local_radiance": geometry.sights}
    pairs = {
        name: [gl.texture((ROW, max(-(-count // ROW), 1)), 4, dtype="f4") for _ in range(2)]
        for name, count in sides.items()
    }
    targets = {name: [gl.framebuffer([t]) for t in pair] for name, pair in pairs.items()}
    for target in targets["local_radiance"]:
        target.clear()
    shaders = {
        "irradiance": program("fullscreen.vert", "vertex_irradiance.frag", defines),
        "local_radiance": program("fullscreen.vert", "local_radiance.frag", defines),
    }
    gl.enable_only(moderngl.NOTHING)
    direct = gl.texture(pairs["irradiance"][0].size, 4, dtype="f4")
    once, target = (
        program("fullscreen.vert", "vertex_direct.frag", defines),
        gl.framebuffer([direct]),
    )
    set_uniforms(once, **uniforms)
    bind_maps(once, maps | geometry.maps)
    fill(target, once)
    now = {name: pair[0] for name, pair in pairs.items()} | {"direct": direct}
    for bounce, asked in enumerate(ASKED):
        if asked > 1 and "LIGHTS" in defines:
            defines |= {"LIT_HITS"}
            shaders["local_radiance"] = program("fullscreen.vert", "local_radiance.frag", defines)
        for name, shader in shaders.items():
            side = (bounce + 1) % 2
            set_uniforms(shader, **uniforms, sight_count=geometry.sights, asked=asked)
            bind_maps(shader, maps | geometry.maps | now)
            fill(targets[name][side], shader)
            now = now | {name: pairs[name][side]}
    release(target, now.pop("direct"))
    for name, both in targets.items():
        release(*both)
        for texture in pairs[name]:
            if texture is not now[name]:
                texture.release()
    gl.finish()
    return Exchanged(now, perf_counter() - start)
