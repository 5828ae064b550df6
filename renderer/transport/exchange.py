"""The light that a scene's surfaces send one another, bounce by bounce."""

from collections.abc import Sequence
from itertools import pairwise
from time import perf_counter
from typing import Any

import moderngl
import numpy as np

from renderer.context import context
from renderer.program import Maps, program
from renderer.transport import rows
from renderer.transport.received import VertexLight, direct_light
from renderer.transport.scene import TOGETHER, SceneGeometry
from renderer.transport.visibility import WITNESSES

BOUNCES = 4  # the last alone is exact; the one before it stands for all later ones, too
MOST_KEPT = 0.8  # of one bounce's light in the next, for what bounces leave out
SHIFT = TOGETHER.bit_length() - 1
NONE_AHEAD = (0.0, 0.0, 0.0)


def exchange(
    geometry: SceneGeometry,
    uniforms: dict[str, Any],
    maps: Maps,
    defines: frozenset[str],
    finely: Sequence[bool],
) -> VertexLight:
    """Send light from surface to surface.

    Args:
        uniforms, maps: of the environment and the materials.
        defines: the features that any of the materials needs.
        finely: whether each object looks into its surroundings through lobes so narrow that in the
            last bounce all witnesses are asked, and lights shaded apart.
    """
    start = perf_counter()
    made, direct = direct_light(geometry, uniforms, maps, defines)
    maps, sky = maps | geometry.maps | made, made["vertex_irradiance"]
    sights = geometry.first_sight[-1]
    beside_lights, *both = (rows.colours(geometry.vertices) for _ in range(3))
    coarse = [rows.packed(sights // TOGETHER) for _ in range(2)]
    gathering = program("fullscreen.vert", "vertex_irradiance.frag", defines)
    sending = program("fullscreen.vert", "local_radiance.frag", defines)
    now = {"direct": direct, "irradiance": direct, "local_radiance": coarse[0]}
    rows.clear(coarse[0])
    told = uniforms | {"sight_shift": SHIFT}
    together = {"sight_range": (0, sights // TOGETHER), "made_shift": SHIFT, "asked": 1}
    sums = [_sum(direct, geometry.vertices)]
    for bounce in range(1, BOUNCES):
        side = bounce % 2
        ahead = _ahead(sums) if bounce == BOUNCES - 1 else NONE_AHEAD
        rows.run([coarse[side]], sending, told | together | {"ahead": ahead}, maps | now)
        now["local_radiance"] = coarse[side]
        rows.run([both[side]], gathering, told, maps | now)
        now["irradiance"] = both[side]
        if bounce < BOUNCES - 1:
            sums.append(_sum(both[side], geometry.vertices))
    made |= {"irradiance": now["irradiance"], "local_radiance": rows.packed(sights)}
    lit = program("fullscreen.vert", "local_radiance.frag", defines | {"LIT_HITS"})
    for fine, (first, end) in zip(finely, pairwise(geometry.first_sight), strict=True):
        own = told | {"sight_range": (first, end), "asked": WITNESSES if fine else 1}
        shader = lit if fine and "LIGHTS" in defines else sending
        rows.run(
            [made["local_radiance"]],
            shader,
            own | {"made_shift": 0, "ahead": NONE_AHEAD},
            maps | now,
            first,
            end,
        )
    if "DIFFUSE" in defines:
        now |= made | {"direct": sky}
        rows.run([beside_lights], gathering, uniforms | {"sight_shift": 0}, maps | now)
        made["vertex_irradiance"] = beside_lights
    for texture in {direct, sky, beside_lights, *both, *coarse} - set(made.values()):
        texture.release()
    context().finish()
    return VertexLight(made, perf_counter() - start)


def _sum(irradiance: moderngl.Texture, vertices: int) -> np.ndarray:
    """Of all vertices, (3,)."""
    texels = np.frombuffer(irradiance.read(), np.float32).reshape(-1, 4)
    return texels[:vertices, :3].sum(axis=0, dtype=float)


def _ahead(sums: list[np.ndarray]) -> tuple[float, ...]:
    """What all later bounces will add, of what the last did, if each keeps as much as it did."""
    before, last = np.diff(sums[-3:], axis=0)
    kept = np.clip(np.nan_to_num(last / np.maximum(before, 1e-30)), 0, MOST_KEPT)
    return tuple((kept / (1 - kept)).tolist())
