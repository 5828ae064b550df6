"""What shaders make of their maps, tables and terms."""

from collections.abc import Collection

import numpy as np

from renderer.features import features
from renderer.precompute import BASE, brdf_table, precomputed
from renderer.precompute.prefilter import LEVELS
from renderer.probe import brdf_values, probe
from renderer.techniques import Technique
from reports.conformance.light import latlong
from reports.conformance.result import Conformance
from reports.conformance.split_sum import split_sum
from reports.conformance.textures import bilinear, clamped, trilinear
from reports.run.conformance.shared import (
    FIRST_UNIT,
    MATERIAL,
    UNIFORMS,
    measured,
    relative,
    spread,
    texels_of,
    uniforms_of,
)
from reports.stability import oracle
from reports.stability.agreement import off_by
from reports.stability.directions import directions
from scenes.schema import Environment, Material, Model

LOBES = ("ggx", "beckmann")


def of_split_sum(
    environment: Environment, material: Material, model: Model, how: Technique
) -> Conformance:
    """What the shader makes of its maps and tables, beside the paper's formula on the same ones."""
    made, names = precomputed(environment.path), how.maps(material, model)
    made.need(names)  # those of a few environments alone are kept
    maps = {n: made.maps[n] for n in (*names, BASE)}
    if how.own_table(model):
        maps["table_smith"] = brdf_table.smith_table(material).texture
    for unit, texture in enumerate(maps.values(), FIRST_UNIT):
        texture.use(unit)
    turn = environment.rotation / 360
    n, v = spread(600, 2), spread(600, 3)
    v = np.where((n * v).sum(axis=1, keepdims=True) < 0, -v, v).astype(np.float32)
    n = n.astype(np.float32)
    ours = probe(
        f"vec4(shade(n.xyz, v.xyz, {MATERIAL}, 0, 1), 0.0)",
        {"n": n, "v": v},
        (how.shade,),
        features(material, model),
        uniforms_of(material)
        | {name: unit for unit, name in enumerate(maps, FIRST_UNIT)}
        | {"environment_turn": turn, "prefilter_levels": float(LEVELS)},
        UNIFORMS,
    )[:, :3]
    n, v = n.astype(float), v.astype(float)
    cosine = (n * v).sum(axis=1)
    r = 2 * cosine[:, None] * n - v
    lod, weight = np.sqrt(material.alpha) * (LEVELS - 1), (material.weight, 1 - material.weight)
    uv, table = latlong(r, turn), np.stack([cosine, np.full(600, material.alpha**0.5)], 1)
    L, ab = np.zeros((600, 4)), np.zeros((600, 4))
    for part, lobe in zip(weight, LOBES, strict=True):
        if not part:
            continue
        levels = [texels_of(maps[f"prefiltered_{lobe}"], k) for k in range(LEVELS)]
        L += part * trilinear(levels, uv, lod)
        if not how.own_table(model):
            ab += part * clamped(texels_of(maps[f"table_{lobe}"]), table)
    if how.own_table(model):
        ab = clamped(texels_of(maps["table_smith"]), table)[:, :2]
    else:
        share = material.masking_weight
        ab = share * ab[:, :2] + (1 - share) * ab[:, 2:]
    E = np.zeros((600, 3))
    if "irradiance_map" in maps:
        E = bilinear(texels_of(maps["irradiance_map"]), latlong(n, turn))[:, :3]
    theirs = split_sum(material, cosine, L[:, :3] / L[:, 3:], ab, E)
    place = f"{material.name}, roughness {material.roughness:g}, in {environment.name}"
    return measured("split sum", relative(ours, theirs), place)


def of_beckmann_over_ggx(alphas: Collection[float]) -> Conformance:
    """The weight by which GGX samples serve Beckmann, point by point, from n to the horizon."""
    slope = np.concatenate([[0], np.geomspace(1e-3, 1e6, 2000), [np.inf]])  # tan over alpha
    slope, alpha = (x.ravel() for x in np.meshgrid(slope, np.array(sorted(alphas))))
    angle = np.arctan(slope * alpha)
    z = np.where(np.isinf(slope), 0, np.cos(angle))
    h = np.stack([np.sin(angle), 0 * angle, z], 1).astype(np.float32)
    alpha = alpha.astype(np.float32)
    ours = probe(
        "vec4(beckmann_over_ggx(h.xyz, alpha.x))",
        {"h": h, "alpha": alpha},
        ("beckmann_over_ggx.glsl",),
    )[:, 0]
    theirs = oracle.beckmann_over_ggx(h, alpha.astype(float))
    off = off_by(ours, theirs, theirs.max())
    at = off.argmax()
    place = f"tan h = {slope[at]:.3g} alpha, alpha {alpha[at]:.3g}"
    return measured("Beckmann over GGX", off[at], place)


def of_horizon(material: Material, model: Model) -> Conformance:
    """What the BRDF sends from or to below the surface: nothing."""
    wi, wo = (w[:2000] for w in directions(material.alpha))
    below = np.float32([1, 1, -1])
    sent = [brdf_values(material, *pair, model) for pair in ((wi * below, wo), (wi, wo * below))]
    return measured("horizon", np.abs(sent).max(), f"{material.name}, masking {model.masking}")
