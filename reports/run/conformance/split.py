"""The maps and tables of the technique `split`, and what its shader makes of them."""

import numpy as np

from renderer.features import features
from renderer.precompute import BASE, brdf_table, precomputed
from renderer.precompute.split import LAYERS
from renderer.probe import probe
from renderer.techniques import Technique
from reports.conformance.kernels import lambert, reflected
from reports.conformance.light import Light, direction, latlong
from reports.conformance.result import Conformance
from reports.conformance.split_sum import scale_bias, smith, towards, vcavity
from reports.conformance.textures import bilinear, clamped
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
from scenes.environment import load_environment
from scenes.schema import ALPHA_MIN, Environment, Material, Model

PLACES = 12  # of a map or a table that are looked at
WIDE = 5  # the first layer whose lobe a sum over the environment resolves: alpha .044
PAIRS = 600  # of n and v
LOBES = {"ggx": oracle.D_ggx, "beckmann": oracle.D_beckmann}


def of_split_maps(environment: Environment, names: set[str]) -> list[Conformance]:
    """The irradiance map, and every other layer of the lobes, at some of their texels."""
    made = precomputed(environment.path)
    made.need(sorted(names))
    light, rng = Light(load_environment(environment.path).radiance), np.random.default_rng(6)
    found = []
    if "irradiance_exact" in names:
        texels = texels_of(made.maps["irradiance_exact"])
        rows, columns, axes = _some(rng, texels.shape, to_poles=True)
        (E,), _, _ = light.convolved(axes, [lambert])
        off = relative(texels[rows, columns, :3], E)
        found.append(measured("irradiance map", off, f"exact, {environment.name}"))
    wanted = sorted(n for n in names if n.startswith("lobe"))
    for layer in range(WIDE, LAYERS, 3) if wanted else ():
        alpha = 2.0 ** ((layer - LAYERS + 1) / 2)
        kernels = [reflected(LOBES[n.removeprefix("lobe_")], alpha) for n in wanted]
        stored = {n: np.split(texels_of(made.maps[n]), LAYERS)[layer] for n in wanted}
        rows, columns, axes = _some(rng, next(iter(stored.values())).shape)
        for name, sums, alone in zip(wanted, *light.convolved(axes, kernels)[:2], strict=True):
            ours = stored[name][rows, columns].astype(float)
            place = f"{name}, layer {layer}, of {environment.name}"
            mean = ours[:, :3] / ours[:, 3:]
            found.append(measured("lobes", relative(mean, sums / alone[:, None]), place))
    return found


def of_split_table(name: str, environment: Environment) -> Conformance:
    """What is reflected, or whereto, at some texels of a table."""
    made = precomputed(environment.path)
    made.need([name])
    texels, rng = texels_of(made.maps[name]), np.random.default_rng(7)
    height, width = texels.shape[:2]
    rows, columns = rng.integers(6, height, PLACES), rng.integers(6, width, PLACES)
    integral = towards if name.startswith("towards") else scale_bias
    weight = (0, 1) if "beckmann" in name else (1, 0)
    theirs = []
    for row, column in zip(rows, columns, strict=True):
        cosine, alpha = (column + 0.5) / width, max(((row + 0.5) / height) ** 2, ALPHA_MIN)
        both = [integral(cosine, alpha, weight, m) for m in (smith(alpha), vcavity)]
        theirs.append(np.concatenate(both))
    return measured("tables", relative(texels[rows, columns], np.array(theirs)), name)


def of_better_split_sum(
    environment: Environment, material: Material, model: Model, how: Technique
) -> Conformance:
    """What the shader makes of its maps and tables, beside the formula on the same ones."""
    made = precomputed(environment.path)
    names = how.maps(material, model)
    made.need(sorted(names))
    maps = {n: made.maps[n] for n in (*names, BASE)}
    if how.own_table(model):
        maps["table_smith"] = brdf_table.smith_table(material).texture
    for unit, texture in enumerate(maps.values(), FIRST_UNIT):
        texture.use(unit)
    turn = environment.rotation / 360
    n, v = spread(PAIRS, 2), spread(PAIRS + 4, 3)[4:]
    v = np.where((n * v).sum(axis=1, keepdims=True) < 0, -v, v).astype(np.float32)
    n = n.astype(np.float32)
    ours = probe(
        f"vec4(shade(n.xyz, v.xyz, {MATERIAL}, 0, 1), 0.0)",
        {"n": n, "v": v},
        (how.shade,),
        features(material, model),
        uniforms_of(material)
        | {name: unit for unit, name in enumerate(maps, FIRST_UNIT)}
        | {"environment_turn": turn, "lobe_layers": float(LAYERS)},
        UNIFORMS,
    )[:, :3]
    theirs = _split(maps, n.astype(float), v.astype(float), material, turn)
    place = f"{material.name}, roughness {material.roughness:g}, in {environment.name}"
    return measured("better split sum", relative(ours, theirs), place)


def _split(maps: dict, n: np.ndarray, v: np.ndarray, material: Material, turn: float) -> np.ndarray:
    """The formula of shade_split.glsl in double precision, (n, 3)."""
    cosine = (n * v).sum(axis=1)
    weight, share = (material.weight, 1 - material.weight), material.masking_weight
    used = [(part, lobe) for part, lobe in zip(weight, LOBES, strict=True) if part]

    def tabled(name: str, at: np.ndarray) -> np.ndarray:
        uv = np.stack([at, 0 * at + material.alpha**0.5], 1)
        found = sum(p * clamped(texels_of(maps[f"{name}_{lobe}"]), uv) for p, lobe in used)
        return share * found[:, :2] + (1 - share) * found[:, 2:]

    def spread_of(at: np.ndarray) -> np.ndarray:
        return 1 - np.linalg.norm(tabled("towards", at), axis=1) / tabled("albedo", at).sum(axis=1)

    ab, x_z = tabled("albedo", cosine), tabled("towards", cosine)
    wider = np.clip(spread_of(cosine) / np.maximum(spread_of(1 + 0 * cosine), 1e-7), 1 / 16, 16)
    layer = 2 * np.log2(material.alpha * np.sqrt(wider)) + LAYERS - 1
    layer = np.clip(layer, 0, LAYERS - 1)
    axis = oracle.view_axis(n, v) * x_z[:, :1] + n * x_z[:, 1:]
    uv = latlong(axis / np.linalg.norm(axis, axis=1, keepdims=True), turn)
    low = np.minimum(np.floor(layer).astype(int), LAYERS - 2)
    sums = np.zeros((len(n), 4))
    for part, lobe in used:
        looked = np.stack(
            [bilinear(one, uv) for one in np.split(texels_of(maps[f"lobe_{lobe}"]), LAYERS)]
        )
        each, between = np.arange(len(n)), (layer - low)[:, None]
        sums += part * (looked[low, each] * (1 - between) + looked[low + 1, each] * between)
    if "table_smith" in maps:
        ab = clamped(texels_of(maps["table_smith"]), np.stack([cosine, 0 * cosine], 1))[:, :2]
    f0, albedo = np.array(material.specular_f0), np.array(material.diffuse_albedo)
    L = sums[:, :3] / sums[:, 3:] * (f0 * ab[:, :1] + ab[:, 1:])
    if "irradiance_exact" in maps:
        exact, uv = texels_of(maps["irradiance_exact"]), latlong(n, turn)
        uv[:, 1] = (uv[:, 1] * (len(exact) - 1) + 0.5) / len(exact)
        E = bilinear(exact, uv)[:, :3]
        L += (1 - _lost(cosine))[:, None] * (1 - f0) * albedo / np.pi * E
    return L


def _lost(cosine: np.ndarray) -> np.ndarray:
    """The mean of (1 - h.v)^5 over cosine-weighted directions, (n,), by quadrature."""
    nodes, areas = np.polynomial.legendre.leggauss(64)
    z, area = (nodes + 1) / 2, areas / 2
    turns = np.cos(np.pi * (np.arange(64) + 0.5) / 64)
    at = np.linspace(0, 1, 257)
    sine = np.sqrt(1 - at**2)
    w_v = at[:, None, None] * z[:, None] + (sine[:, None] * np.sqrt(1 - z**2))[..., None] * turns
    means = (1 - np.sqrt((1 + np.clip(w_v, -1, 1)) / 2)) ** 5
    return np.interp(cosine, at, means.mean(axis=2) @ (2 * z * area))


def _some(
    rng: np.random.Generator, shape: tuple[int, ...], to_poles: bool = False
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows, columns and directions of some texels of a lat-long map, or one from pole to pole."""
    rows, columns = (rng.integers(0, size, PLACES) for size in shape[:2])
    polar = rows / (shape[0] - 1) if to_poles else (rows + 0.5) / shape[0]
    uv = np.stack([(columns + 0.5) / shape[1], polar], 1)
    return rows, columns, direction(uv)
