"""What the technique `filtered` samples, takes out of the environment and makes of both."""

from dataclasses import replace

import numpy as np

from renderer.features import features, split_samples
from renderer.precompute import BASE, precomputed
from renderer.precompute.blurred import levels_of as levels_of_lights
from renderer.precompute.blurred import light_uniforms
from renderer.precompute.lights import extract, texel_angles
from renderer.probe import probe
from renderer.techniques import Technique
from reports.conformance.kernels import fourth_order
from reports.conformance.light import Light, direction
from reports.conformance.result import Conformance
from reports.run.conformance.shared import (
    FIRST_UNIT,
    MATERIAL,
    UNIFORMS,
    levels_of,
    measured,
    relative,
    spread,
    texels_of,
    uniforms_of,
)
from reports.stability import oracle
from reports.stability.agreement import off_by, peaks
from reports.stability.directions import directions
from scenes.environment import load_environment
from scenes.schema import Environment, Material, Model

MAPS = ("blurred_map", "lights_map")
PLACES = 12  # of a level that are looked at
LEVELS = (2, 4, 6)  # wider kernels are bounded by the sphere
SPREAD = 0.25  # a kernel's variance an axis, of the solid angle that a sample stands for
PAIRS = 24  # of n and v
ENOUGH = 1024  # directions, for what is left to be no share of any one of them
SUMMED = 256  # columns, at most, of the level of the environment that is summed over
WIDE = 0.04  # the least alpha whose lobe that level resolves


def of_filtered_samples(material: Material, how: Technique) -> list[Conformance]:
    """Where the samples lie, and the density by which they are divided."""
    count, alpha = 256, material.alpha
    index, points = np.arange(count), np.full(count, count)
    u = probe(f"vec4(spiral(int(i.x), {count}, 0, 1), 0.0, 0.0)", {"i": index}, ("spiral.glsl",))
    u = u[:, :2]
    found = [measured("samples", np.abs(u - oracle.spiral(index, points)).max(), "spiral")]
    z = np.linspace(0.05, 1, count)
    wo = np.stack([np.sqrt(1 - z**2), 0 * z, z], 1).astype(np.float32)
    call = f"vec4(sample_visible_ggx(u.xy, wo.xyz, {alpha:.9g}), 0.0)"
    made = probe(call, {"u": u, "wo": wo}, ("sample_visible_ggx.glsl",))[:, :3]
    off = np.abs(made - oracle.sampled_visible_ggx(u, wo, alpha)).max()
    found.append(measured("samples", off, f"sample_visible_ggx, alpha {alpha:.3g}"))
    ggx, beckmann, cosine = split_samples(material, how.per_pixel(material))
    wi, wo = directions(alpha)
    ours = probe(
        f"vec4(filtered_density(wi.xyz, wo.xyz, {MATERIAL}, ivec2({ggx + beckmann}, {cosine})))",
        {"wi": wi, "wo": wo},
        (how.shade,),
        features(material),
        uniforms_of(material),
        UNIFORMS,
    )[:, :1]
    theirs = oracle.filtered_density(wi, wo, alpha, np.array([ggx + beckmann, cosine]))[:, None]
    off = off_by(ours, theirs, peaks(theirs, wo[:, 2]))
    found.append(measured("densities", off.max(), f"{material.name}, alpha {alpha:.3g}"))
    return found


def of_taken_out(environment: Environment) -> list[Conformance]:
    """Whether the light and its lights hold all power together, and levels are what they say."""
    made = precomputed(environment.path)
    made.need(MAPS)
    radiance = load_environment(environment.path).radiance
    light, (height, width) = Light(radiance), radiance.shape[:2]
    lights = extract(radiance)
    gone = levels_of_lights(lights, width)
    angles = np.repeat(texel_angles(height, width), width)
    found = []
    rest = lights.rest(gone >= 0)
    whole, left = (angles @ x.reshape(-1, 3).astype(float) for x in (radiance, rest))
    stored = texels_of(made.maps["lights_map"])[1, :, :3].astype(float).sum(axis=0)
    found.append(measured("power of lights", relative(left + stored, whole), environment.name))
    for level in (x for x in LEVELS if max(height, width) >> x):
        texels = texels_of(made.maps["blurred_map"], level)[..., :3]
        rng = np.random.default_rng(level)
        rows, columns = (rng.integers(0, n, PLACES) for n in texels.shape[:2])
        uv = np.stack([(columns + 0.5) / texels.shape[1], (rows + 0.5) / texels.shape[0]], 1)
        uv[:, 1] = np.clip((uv[:, 1] * height - 0.5) / (height - 1), 0, 1)
        kernel = fourth_order(SPREAD * 4.0**level * (2 * np.pi / width) ** 2)
        light = Light(lights.rest(gone <= level))
        (sums,), (alone,), _ = light.convolved(direction(uv), [kernel])
        off = relative(texels[rows, columns], sums / alone[:, None])
        found.append(measured("blurred levels", off, f"level {level} of {environment.name}"))
    return found


def of_filtered_light(
    environment: Environment, material: Material, model: Model, how: Technique
) -> list[Conformance]:
    """What the shader sums up with many directions, beside the sum over the environment."""
    if material.alpha < WIDE:
        return []
    made = precomputed(environment.path)
    read = how.maps(material, model)
    made.need(read)
    maps = {name: made.maps[name] for name in (BASE, *read) if name != "lights_map"}
    turn = environment.rotation / 360
    for unit, texture in enumerate(maps.values(), FIRST_UNIT):
        texture.use(unit)
    n, v = spread(PAIRS, 4), spread(PAIRS + 4, 5)[4:]
    toward = np.abs((n * v).sum(axis=1, keepdims=True))
    v = np.where(toward < 0.2, n + v, v)  # what grazes reflects too sharply for the sum
    v /= np.linalg.norm(v, axis=1, keepdims=True)
    v = np.where((n * v).sum(axis=1, keepdims=True) < 0, -v, v).astype(np.float32)
    n = n.astype(np.float32)
    lights = light_uniforms(made.maps["lights_map"], turn)
    ggx, beckmann, cosine = split_samples(material, replace(how, samples=ENOUGH).samples)
    many = {"specular_samples": (ggx + beckmann,) * 4, "cosine_samples": (cosine,) * 4}
    ours = probe(
        f"vec4(shade(n.xyz, v.xyz, {MATERIAL}, 0, 1), 0.0)",
        {"n": n, "v": v},
        (how.shade,),
        features(material, model) | ({"LIGHTS"} if lights else set()),
        uniforms_of(material)
        | {name: unit for unit, name in enumerate(maps, FIRST_UNIT)}
        | {"environment_turn": turn, "light_sharers": 1.0}
        | many
        | lights,
        UNIFORMS,
    )[:, :3]
    level = next(x for x in levels_of(made.maps) if x.shape[1] <= SUMMED)
    height = len(texels_of(made.maps[BASE]))
    if level.shape[1] < SUMMED // 2:  # a small map, whose texels are wider than the lobe
        level, height = _finer(Light(level)), SUMMED // 2
    theirs = _summed(level, height, turn, n, v)
    theirs = theirs(material, model)
    place = f"{material.name}, roughness {material.roughness:g}, in {environment.name}"
    return [measured("filtered light", relative(ours, theirs), place)]


def _finer(light: Light) -> np.ndarray:
    """A map of SUMMED columns, (SUMMED / 2, SUMMED, 3), of the same light."""
    rows, columns = np.indices((SUMMED // 2, SUMMED)).reshape(2, -1)
    uv = np.stack([(columns + 0.5) / SUMMED, rows / (SUMMED // 2 - 1)], 1)
    return light.at(direction(uv)).reshape(SUMMED // 2, SUMMED, 3)


def _summed(level: np.ndarray, height: int, turn: float, n: np.ndarray, v: np.ndarray):
    """The integral of light and BRDF, (n, 3), as a function of a material and a model."""
    rows, columns = level.shape[:2]
    edges = np.clip((np.arange(rows + 1) / rows * height - 0.5) / (height - 1), 0, 1)
    angles = np.repeat(-np.diff(np.cos(np.pi * edges)) * 2 * np.pi / columns, columns)
    y, x = (np.indices((rows, columns)).reshape(2, -1) + 0.5) / [[rows], [columns]]
    polar = np.clip((y * height - 0.5) / (height - 1), 0, 1)
    world = direction(np.stack([x, polar], 1), turn)
    power = level.reshape(-1, 3).astype(float) * angles[:, None]

    def over(material: Material, model: Model) -> np.ndarray:
        sums = []
        for normal, eye in zip(n.astype(float), v.astype(float), strict=True):
            z = normal / np.linalg.norm(normal)
            axis = oracle.view_axis(z[None], eye[None])[0]
            frame = np.stack([axis, np.cross(z, axis), z], 1)
            wi = world @ frame
            up = wi[:, 2] > 1e-6
            wo = np.broadcast_to(eye @ frame, (int(up.sum()), 3))
            f = oracle.oracle(material, wi[up], wo, model.masking)
            sums.append((f * wi[up, 2:] * power[up]).sum(axis=0))
        return np.array(sums)

    return over
