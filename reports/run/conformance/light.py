"""The radiance map: what is stored of the light, and how shaders look it up."""

import numpy as np

from renderer.precompute import BASE, precomputed
from renderer.probe import probe
from renderer.program import bind_maps, program, set_uniforms
from reports.conformance.light import Light
from reports.conformance.result import Conformance
from reports.conformance.textures import trilinear
from reports.run.conformance.shared import (
    FIRST_UNIT,
    filled,
    levels_of,
    measured,
    relative,
    spread,
    texels_of,
)
from scenes.environment import load_environment
from scenes.schema import Environment


def of_light(environment: Environment) -> list[Conformance]:
    """The radiance map, its levels, and how shaders look it up, pick a level and draw it."""
    maps, name = precomputed(environment.path).maps, environment.name
    light, world = Light(load_environment(environment.path).radiance), spread(512, 1)
    world, turn, levels = (
        world.astype(np.float32).astype(float),
        environment.rotation / 360,
        levels_of(maps),
    )
    density = np.geomspace(1e-3, 1e6, len(world)).astype(np.float32).astype(float)
    given = np.hstack([world, density[:, None]])
    pairs = {
        "look-ups": (
            _looked_up(maps, "vec4(radiance(at.xyz, 0.0), 0.0)", given, turn)[:, :3],
            light.at(world, turn),
        ),
        "look-ups between levels": (
            _looked_up(maps, "vec4(radiance(at.xyz, 2.5), 0.0)", given, turn)[:, :3],
            trilinear(levels, light.place(world, turn), 2.5),
        ),
        "choice of levels": (
            _looked_up(maps, "vec4(radiance_lod(at.xyz, at.w, 3.0))", given, turn)[:, 0],
            light.level(world, 1 / (3 * density)),
        ),
        "background": _background(maps, levels, light, turn),
    }
    found = [
        measured("light", relative(*pair), f"{where} of {name}") for where, pair in pairs.items()
    ]
    below = light.radiance
    height, width = below.shape[:2]
    edges = np.clip((np.arange(height + 1) - 0.5) / (height - 1), 0, 1)
    weights, level = -np.diff(np.cos(np.pi * edges)), 0
    while height % 2 == 0 and width % 2 == 0:
        height, width, level = height // 2, width // 2, level + 1
        pairs = weights.reshape(height, 2)
        rows = (below.reshape(height, 2, *below.shape[1:]) * pairs[..., None, None]).sum(axis=1)
        below = (rows / pairs.sum(axis=1)[:, None, None]).reshape(height, width, 2, 3).mean(axis=2)
        weights = pairs.sum(axis=1)
        off = relative(texels_of(maps[BASE], level)[..., :3], below)
        found.append(measured("levels of the light", off, f"level {level} of {name}"))
    return found


def _looked_up(maps: dict, expression: str, world: np.ndarray, turn: float) -> np.ndarray:
    maps[BASE].use(FIRST_UNIT)
    uniforms = {BASE: FIRST_UNIT, "environment_turn": turn}
    return probe(expression, {"at": world}, ("radiance.glsl",), uniforms=uniforms)


def _background(
    maps: dict, levels: list[np.ndarray], light: Light, turn: float
) -> tuple[np.ndarray, np.ndarray]:
    """What a wide and coarse picture shows of the light alone, and what it should: (n, 3) each."""
    size, tangents = (24, 18), (2.0, 1.5)
    forward, right, up = np.array([[0.0, 0.8, -0.6], [1, 0, 0], [0, 0.6, 0.8]])
    right, up = right * tangents[0], up * tangents[1]
    area = 4 * tangents[0] * tangents[1] / (size[0] * size[1])
    shader = program("fullscreen.vert", "background.frag")
    uniforms = {"forward": forward, "right": right, "up": up, "picture_corner": (0, 0)}
    uniforms |= {"picture_size": size, "pixel_area": area, "environment_turn": turn}
    set_uniforms(shader, **uniforms)
    bind_maps(shader, {BASE: maps[BASE]})
    ours = filled(shader, size)[:, :3]
    y, x = ((np.indices(size[::-1]).reshape(2, -1).T + 0.5) / size[::-1] * 2 - 1).T
    ray = forward + x[:, None] * right + y[:, None] * up
    distance = np.linalg.norm(ray, axis=1)
    world = ray / distance[:, None]
    lod = light.level(world, area / distance**3)
    return ours, trilinear(levels, light.place(world, turn), lod)
