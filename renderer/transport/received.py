"""The environment's light on a scene's vertices."""

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import moderngl

from renderer.context import context
from renderer.precompute.lights import MOST
from renderer.program import Maps, program
from renderer.transport import rows
from renderer.transport.scene import SceneGeometry
from renderer.transport.visibility import SEEN

PASS_LIGHTS = 16  # of a vertex in one pass, for its rays visit many nodes; as in lights.glsl


@dataclass(frozen=True, eq=False)
class VertexLight:
    """What was made of each vertex, row by row, and the seconds that it took.

    Attributes:
        maps: `vertex_irradiance`, of all that shines on it but lights; and where surfaces send
            light, `irradiance` with lights and, packed, `local_radiance` of each sight.
    """

    maps: Maps
    seconds: float


def received(
    geometry: SceneGeometry, uniforms: dict[str, Any], maps: Maps, defines: frozenset[str]
) -> VertexLight:
    """Light the vertices by what is open of the environment; arguments as of `exchange`."""
    start = perf_counter()
    made, direct = direct_light(geometry, uniforms, maps, defines)
    direct.release()
    context().finish()
    return VertexLight(made, perf_counter() - start)


def direct_light(
    geometry: SceneGeometry, uniforms: dict[str, Any], maps: Maps, defines: frozenset[str]
) -> tuple[Maps, moderngl.Texture]:
    """Of each vertex which lights it sees and what else comes straight from the environment; and
    what comes from there with its lights."""
    context().enable_only(moderngl.NOTHING)
    maps = maps | geometry.maps
    all_of_it, beside_lights = (rows.colours(geometry.vertices) for _ in range(2))
    made = {"vertex_irradiance": beside_lights}
    if "LIGHTS" in defines:
        made["vertex_lights"] = _lights(geometry, uniforms, maps)
    coarse_sky = rows.colours(SEEN**2)
    rows.run([coarse_sky], program("fullscreen.vert", "coarse_sky.frag"), uniforms, maps)
    shader = program("fullscreen.vert", "vertex_direct.frag", defines)
    maps = maps | made | {"coarse_sky": coarse_sky}
    rows.run([all_of_it, beside_lights], shader, uniforms, maps)
    coarse_sky.release()
    return made, all_of_it


def _lights(geometry: SceneGeometry, uniforms: dict[str, Any], maps: Maps) -> moderngl.Texture:
    """Of each vertex a bit for each light that it sees."""
    made = rows.empty(geometry.vertices, 4, "u4")
    shader = program("fullscreen.vert", "vertex_lights.frag")
    for channel in range(MOST // PASS_LIGHTS):
        told = uniforms | {"first_light": PASS_LIGHTS * channel}
        rows.run([made], shader, told, maps, channel=channel)
    return made
