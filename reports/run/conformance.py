"""Holds what the renderer precomputes and samples against its definitions, for a suite's cases."""

from collections.abc import Iterable
from functools import lru_cache

import moderngl
import numpy as np

from renderer.context import context
from renderer.features import Technique, features, split_samples, technique
from renderer.objects import placed
from renderer.precompute import BASE, Precomputed, brdf_table, precomputed
from renderer.precompute.prefilter import LEVELS, SAMPLES, SIZE
from renderer.probe import brdf_values, probe
from renderer.program import bind_maps, fill, program, set_uniforms
from renderer.targets import release
from renderer.view import view
from reports import conformance as defined
from reports.conformance import Conformance, Light
from reports.stability import oracle
from reports.stability.directions import directions
from scenes.environment import load_environment
from scenes.mesh import placement
from scenes.schema import ALPHA_MIN, Case, Environment, Material, Model
from scenes.suite import Entry

# What a correct renderer is off by, measured over the suites that come with the code, and some
# room. Maps are held as root mean squares over the places that are looked at, relative to theirs.
ALLOWED = {
    "light": 2e-3,
    "levels of the light": 1e-5,
    "irradiance map": 5e-3,
    "prefiltered maps": 0.02,
    "prefiltered weights": 0.01,
    "mirror's map": 0.03,
    "tables": 0.01,
    "split sum": 5e-3,
    "samples": 1e-4,
    "densities": 1e-3,
    "horizon": 0.0,
    "normals": 1e-5,
}
PLACES = 16  # of a map or table that are looked at; fewer where the light has more cells
AFFORDED, FEWEST_PLACES = 40_000, 6
QUIETER = 0.25  # a map's samples are regular and filtered: a quarter of random ones' noise, at most
FIRST_UNIT = 8  # texture units below are the probe's own
MATERIAL = "Material(albedo, f0, alpha, weight_d, weight_g)"
UNIFORMS = "uniform vec3 albedo, f0; uniform float alpha; uniform vec2 weight_d, weight_g;"
LOBES = {"ggx": oracle.D_ggx, "beckmann": oracle.D_beckmann}


def conformance(entries: Iterable[Entry]) -> list[Conformance]:
    """The worst differences of each kind, over what the techniques of some entries use."""
    found: list[Conformance] = []
    used = [
        (e.case, o.material, technique(name))
        for e in entries
        for o in e.case.objects
        for name in e.techniques
    ]
    found.append(of_normals(used[0][0]))
    for environment in {c.environment.path: c.environment for c, _, _ in used}.values():
        found += of_light(environment)
    split = [(c, m, t) for c, m, t in used if not t.samples]
    read: dict[Environment, set[str]] = {}
    for case, material, how in split:
        read.setdefault(case.environment, set()).update(how.maps(material, case.model))
    found += [of_mirror(e) for e in {e.path: e for e in read}.values()]
    for path in {e.path for e in read}:
        names = set().union(*(maps for e, maps in read.items() if e.path == path))
        precomputed(path).need(sorted(names))
        found += of_maps(
            precomputed(path), Light(load_environment(path).radiance), names, path.stem
        )
    tables = {n for names in read.values() for n in names if n.startswith("table")}
    found += [of_table(precomputed(next(iter(read)).path), name) for name in sorted(tables)]
    found += [of_own_table(m) for m in {m for c, m, t in split if t.own_table(c.model)}]
    # Each surface in one environment, and each environment with one surface.
    surfaces = {(m, c.model, t.shade, t.fine): (c, m, t) for c, m, t in split}
    lights = {c.environment: (c, m, t) for c, m, t in split}
    for case, material, how in dict.fromkeys([*surfaces.values(), *lights.values()]):
        found.append(of_split_sum(case.environment, material, case.model, how))
    found += [
        of_horizon(m, c.model) for c, m in {(m, c.model): (c, m) for c, m, _ in used}.values()
    ]
    for material, how in {(m, t) for _, m, t in used if t.samples}:
        found += of_samples(material, how)
    return [
        max((f for f in found if f.name == name), key=lambda f: np.nan_to_num(f.off, nan=np.inf))
        for name in dict.fromkeys(f.name for f in found)
    ]


def _made(name: str, off: float, place: str) -> Conformance:
    return Conformance(name, float(off), ALLOWED[name], place)


def _off(ours: np.ndarray, theirs: np.ndarray) -> float:
    """The root mean square difference, relative to that of `theirs`."""
    size = np.sqrt((theirs.astype(float) ** 2).mean())
    return float(np.sqrt(((ours - theirs.astype(float)) ** 2).mean()) / max(size, 1e-30))


@lru_cache(maxsize=64)
def _texels(texture: moderngl.Texture, level: int = 0) -> np.ndarray:
    """A float32 RGBA texture's level, (H, W, 4)."""
    size = max(texture.width >> level, 1), max(texture.height >> level, 1)
    return np.frombuffer(texture.read(level=level), np.float32).reshape(size[1], size[0], 4)


def _spread(count: int, seed: int) -> np.ndarray:
    """Unit directions (count, 3), the poles and both sides of the seam among them."""
    rng = np.random.default_rng(seed)
    z, phi = rng.uniform(-1, 1, count), rng.uniform(0, 2 * np.pi, count)
    s = np.sqrt(1 - z**2)
    some = np.stack([s * np.sin(phi), s * np.cos(phi), z], 1)
    some[:4] = [0, 0, 1], [0, 0, -1], [1e-3, 1, 0], [-1e-3, 1, 0]
    return some / np.linalg.norm(some, axis=1, keepdims=True)


def of_normals(case: Case) -> Conformance:
    """Normals of one large triangle on a stretched and turned object, pixel by pixel.

    What interpolation does is next to nothing on a finely divided mesh, and all there is on a
    coarse one.
    """
    thing = case.objects[0].model_copy(
        update={"scale": (2.0, 0.5, 1.0), "rotate": (20.0, 30.0, 40.0), "height": None}
    )
    corners = np.float32([[-1, -1, 0], [3, -1, 0], [-1, 3, 0]])
    normals = np.float32([[0.6, 0, 0.8], [0, 1, 0], [-0.48, 0.6, 0.64]])
    shader, size = program("mesh.vert", "surface.frag"), (16, 16)
    whole = np.eye(4, dtype=np.float32).tobytes()
    set_uniforms(shader, **placed(thing, view(case)) | {"to_clip": whole, "number": 1.0})
    gl = context()
    vertices = gl.buffer(np.hstack([corners, normals]).tobytes())
    triangle = gl.vertex_array(shader, [(vertices, "3f 3f", "position", "normal")])
    ours = _filled(triangle, size)[:, :3]
    release(triangle, vertices)
    y, x = (np.indices(size).reshape(2, -1) + 0.5) / 16 / 2  # barycentric; corners lie outside
    world = normals @ np.linalg.inv(placement(thing)[:3, :3])
    world /= np.linalg.norm(world, axis=1, keepdims=True)
    theirs = (1 - x - y)[:, None] * world[0] + x[:, None] * world[1] + y[:, None] * world[2]
    theirs /= np.linalg.norm(theirs, axis=1, keepdims=True)
    return _made("normals", _off(ours, theirs), "a stretched triangle")


def of_light(environment: Environment) -> list[Conformance]:
    """The radiance map, its levels, and how shaders look it up, pick a level and draw it."""
    maps, name = precomputed(environment.path).maps, environment.name
    light, world = Light(load_environment(environment.path).radiance), _spread(512, 1)
    world, turn, levels = (
        world.astype(np.float32).astype(float),
        environment.rotation / 360,
        _all(maps),
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
            defined.trilinear(levels, light.place(world, turn), 2.5),
        ),
        "choice of levels": (
            _looked_up(maps, "vec4(radiance_lod(at.xyz, at.w, 3.0))", given, turn)[:, 0],
            light.level(world, 1 / (3 * density)),
        ),
        "background": _background(maps, levels, light, turn),
    }
    found = [_made("light", _off(*pair), f"{where} of {name}") for where, pair in pairs.items()]
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
        off = _off(_texels(maps[BASE], level)[..., :3], below)
        found.append(_made("levels of the light", off, f"level {level} of {name}"))
    return found


def _looked_up(maps: dict, expression: str, world: np.ndarray, turn: float) -> np.ndarray:
    maps[BASE].use(FIRST_UNIT)
    uniforms = {BASE: FIRST_UNIT, "environment_turn": turn}
    return probe(expression, {"at": world}, ("radiance.glsl",), uniforms=uniforms)


def _all(maps: dict) -> list[np.ndarray]:
    """Every level of the radiance map, (H, W, 3) each."""
    count = max(maps[BASE].width, maps[BASE].height).bit_length()
    return [_texels(maps[BASE], level)[..., :3] for level in range(count)]


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
    ours = _filled(shader, size)[:, :3]
    y, x = ((np.indices(size[::-1]).reshape(2, -1).T + 0.5) / size[::-1] * 2 - 1).T
    ray = forward + x[:, None] * right + y[:, None] * up
    distance = np.linalg.norm(ray, axis=1)
    world = ray / distance[:, None]
    lod = light.level(world, area / distance**3)
    return ours, defined.trilinear(levels, light.place(world, turn), lod)


def _filled(drawn: moderngl.Program | moderngl.VertexArray, size: tuple[int, int]) -> np.ndarray:
    """What a fragment program, or triangles, write into `size` (width, height) pixels.

    Returns:
        (n, 4), rows from the bottom.
    """
    target = context().framebuffer([context().texture(size, 4, dtype="f4")])
    if isinstance(drawn, moderngl.Program):
        fill(target, drawn)
    else:
        target.use()
        drawn.render()
    pixels = np.frombuffer(target.read(components=4, dtype="f4"), np.float32).reshape(-1, 4)
    release(target, *target.color_attachments)
    return pixels


def of_mirror(environment: Environment) -> Conformance:
    """What a mirror would see in a map of coarse texels: the light over each, not a point of it."""
    maps, light = (
        precomputed(environment.path).maps,
        Light(load_environment(environment.path).radiance),
    )
    size = (32, 16)
    shader = program("fullscreen.vert", "prefilter.frag", frozenset({"D_GGX"}))
    set_uniforms(shader, alpha=ALPHA_MIN, count=1, size=size)
    bind_maps(shader, {BASE: maps[BASE]})
    sums = _filled(shader, size)
    y, x = (np.indices(size[::-1]).reshape(2, -1) + 0.5) / np.array(size[::-1])[:, None]
    theirs = _mirrored(_all(maps), light, defined.direction(np.stack([x, y], 1)), size)
    place = f"a coarse one of {environment.name}"
    return _made("mirror's map", _off(sums[:, :3] / sums[:, 3:], theirs), place)


def of_maps(made: Precomputed, light: Light, names: set[str], place_of: str) -> list[Conformance]:
    """The irradiance map and the prefiltered ones, at some of their texels."""
    maps = made.maps
    found = []
    if "irradiance_map" in names:
        texels = _texels(maps["irradiance_map"])
        rows, columns, axes = _some(texels, light)
        (E,), _, _ = light.convolved(axes, [defined.lambert])
        off = _off(texels[rows, columns, :3], E)
        found.append(_made("irradiance map", off, place_of))
    wanted = sorted(n for n in names if n.startswith("prefiltered"))
    for level in range(LEVELS) if wanted else ():
        alpha = max((level / (LEVELS - 1)) ** 2, ALPHA_MIN)
        levels = {n: _texels(maps[n], level) for n in wanted}
        rows, columns, axes = _some(next(iter(levels.values())), light)
        if level == 0:
            theirs = _mirrored(_all(maps), light, axes, SIZE)
            for name, texels in levels.items():
                mean = texels[rows, columns, :3] / texels[rows, columns, 3:]
                found.append(_made("mirror's map", _off(mean, theirs), f"{name} of {place_of}"))
            continue
        kernels = [defined.reflected(LOBES[n.removeprefix("prefiltered_")], alpha) for n in wanted]
        for name, *theirs in zip(wanted, *light.convolved(axes, kernels), strict=True):
            ours = levels[name][rows, columns].astype(float)
            off, noise = _sampled_off(ours, *theirs)
            place = f"{name}, level {level}, of {place_of}"
            found.append(_made("prefiltered maps", off - QUIETER * noise, place))
            off = _off(ours[:, 3], theirs[1])
            found.append(_made("prefiltered weights", off, place))
    return found


def _mirrored(
    levels: list[np.ndarray], light: Light, axes: np.ndarray, size: tuple[int, int]
) -> np.ndarray:
    """The light over texels of a map of `size` (width, height), (n, 3)."""
    sine = np.maximum(np.hypot(axes[:, 0], axes[:, 1]), 0.5 / size[1])
    lod = light.level(axes, 2 * np.pi**2 * sine / (size[0] * size[1]))
    return defined.trilinear(levels, light.place(axes), lod)


def _sampled_off(
    ours: np.ndarray, sums: np.ndarray, alone: np.ndarray, squares: np.ndarray
) -> tuple[float, float]:
    """How far the radiance that a map stores is off, and how far random samples would be.

    The map's own samples are regular and filtered, so that they do better.
    """
    size = np.sqrt((sums**2).mean())
    spread = np.sqrt(np.maximum(squares - sums**2, 0).mean() / SAMPLES)
    return _off(ours[:, :3], sums), float(spread / max(size, 1e-30))


def _some(texels: np.ndarray, light: Light) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows, columns and directions of some texels of a lat-long map, all corners among them."""
    height, width = texels.shape[:2]
    count = max(int(PLACES * min(AFFORDED / light.cells, 1)), FEWEST_PLACES)
    rng = np.random.default_rng(height)
    rows = np.concatenate([[0, 0, height - 1, height - 1], rng.integers(0, height, count - 4)])
    columns = np.concatenate([[0, width - 1] * 2, rng.integers(0, width, count - 4)])
    uv = np.stack([(columns + 0.5) / width, (rows + 0.5) / height], 1)
    return rows, columns, defined.direction(uv)


def of_table(made: Precomputed, name: str) -> Conformance:
    """A table that all materials share, at some of its texels."""
    texels = _texels(made.maps[name])
    size = brdf_table.SIZE
    rng = np.random.default_rng(5)
    columns = np.concatenate([rng.integers(8, size[0], PLACES - 1), [size[0] - 1]])
    rows = np.concatenate([[size[1] - 1], rng.integers(8, size[1], PLACES - 1)])
    weight = (0, 1) if "beckmann" in name else (1, 0)
    theirs = []
    for row, column in zip(rows, columns, strict=True):
        cosine, alpha = (column + 0.5) / size[0], max(((row + 0.5) / size[1]) ** 2, ALPHA_MIN)
        maskings = (defined.smith(alpha), defined.vcavity)
        theirs.append(
            np.concatenate([defined.scale_bias(cosine, alpha, weight, m) for m in maskings])
        )
    return _made("tables", _off(texels[rows, columns], np.array(theirs)), name)


def of_own_table(material: Material) -> Conformance:
    """A material's own table under the masking `smith`."""
    (texels,) = _texels(brdf_table.smith_table(material).texture)
    weight, weight_g = ((w, 1 - w) for w in (material.weight, material.masking_weight))
    masking = defined.smith(material.alpha, weight_g)
    columns = range(8, len(texels), 29)
    theirs = [
        defined.scale_bias((c + 0.5) / len(texels), material.alpha, weight, masking)
        for c in columns
    ]
    off = _off(texels[list(columns), :2], np.array(theirs))
    return _made("tables", off, f"{material.name}'s own")


def of_split_sum(
    environment: Environment, material: Material, model: Model, how: Technique
) -> Conformance:
    """What the shader makes of its maps and tables, beside the paper's formula on the same ones."""
    made = precomputed(environment.path)
    maps = {n: made.maps[n] for n in how.maps(material, model)} | {BASE: made.maps[BASE]}
    if how.own_table(model):
        maps["table_smith"] = brdf_table.smith_table(material).texture
    for unit, texture in enumerate(maps.values(), FIRST_UNIT):
        texture.use(unit)
    turn = environment.rotation / 360
    n, v = _spread(600, 2), _spread(600, 3)
    v = np.where((n * v).sum(axis=1, keepdims=True) < 0, -v, v).astype(np.float32)
    n = n.astype(np.float32)
    ours = probe(
        f"vec4(shade(n.xyz, v.xyz, {MATERIAL}, 0, 1), 0.0)",
        {"n": n, "v": v},
        (how.shade,),
        features(material, model),
        _uniforms(material)
        | {name: unit for unit, name in enumerate(maps, FIRST_UNIT)}
        | {"environment_turn": turn, "prefilter_levels": float(LEVELS)},
        UNIFORMS,
    )[:, :3]
    n, v = n.astype(float), v.astype(float)
    cosine = (n * v).sum(axis=1)
    r = 2 * cosine[:, None] * n - v
    lod, weight = np.sqrt(material.alpha) * (LEVELS - 1), (material.weight, 1 - material.weight)
    uv, table = defined.latlong(r, turn), np.stack([cosine, np.full(600, material.alpha**0.5)], 1)
    L, ab = np.zeros((600, 4)), np.zeros((600, 4))
    for part, lobe in zip(weight, LOBES, strict=True):
        if not part:
            continue
        levels = [_texels(maps[f"prefiltered_{lobe}"], k) for k in range(LEVELS)]
        L += part * defined.trilinear(levels, uv, lod)
        if not how.own_table(model):
            ab += part * defined.clamped(_texels(maps[f"table_{lobe}"]), table)
    if how.own_table(model):
        ab = defined.clamped(_texels(maps["table_smith"]), table)[:, :2]
    else:
        share = material.masking_weight
        ab = share * ab[:, :2] + (1 - share) * ab[:, 2:]
    E = np.zeros((600, 3))
    if "irradiance_map" in maps:
        E = defined.bilinear(_texels(maps["irradiance_map"]), defined.latlong(n, turn))[:, :3]
    theirs = defined.split_sum(material, cosine, L[:, :3] / L[:, 3:], ab, E)
    place = f"{material.name}, roughness {material.roughness:g}, in {environment.name}"
    return _made("split sum", _off(ours, theirs), place)


def of_horizon(material: Material, model: Model) -> Conformance:
    """What the BRDF sends from or to below the surface: nothing."""
    wi, wo = (w[:2000] for w in directions(material.alpha))
    below = np.float32([1, 1, -1])
    sent = [brdf_values(material, *pair, model) for pair in ((wi * below, wo), (wi, wo * below))]
    return _made("horizon", np.abs(sent).max(), f"{material.name}, masking {model.masking}")


def of_samples(material: Material, how: Technique) -> list[Conformance]:
    """Where a technique's samples lie, and the density by which it divides."""
    index = np.arange(1024)
    found, u = [], oracle.hammersley(index, np.full(1024, 1024))
    ours = probe("vec4(hammersley(uint(i.x), 1024u), 0.0, 0.0)", {"i": index}, ("hammersley.glsl",))
    found.append(_made("samples", np.abs(ours[:, :2] - u).max(), "hammersley"))
    alpha = material.alpha
    for lobe in ("ggx", "beckmann", "cosine"):
        given = "u.xy" if lobe == "cosine" else f"u.xy, {alpha:.9g}"
        made = probe(f"vec4(sample_{lobe}({given}), 0.0)", {"u": u}, (f"sample_{lobe}.glsl",))
        made = made[:, :3].astype(float)
        length = np.linalg.norm(made, axis=1)
        # By sine and cosine, which do not jump where a turn is whole.
        phi = 2 * np.pi * u[:, 1]
        flat = np.hypot(made[:, 0], made[:, 1])
        offs = [
            length - 1,
            made[:, 0] - flat * np.cos(phi),
            made[:, 1] - flat * np.sin(phi),
        ]
        offs.append(defined.cumulated(lobe, made[:, 2] / length, alpha) - u[:, 0])
        found.append(_made("samples", np.abs(offs).max(), f"sample_{lobe}, alpha {alpha:.3g}"))
    count = split_samples(material, how.samples_per_set * how.sets)
    wi, wo = directions(alpha)
    ours = probe(
        f"vec4(sample_density(wi.xyz, wo.xyz, {MATERIAL}, ivec3({', '.join(map(str, count))})))",
        {"wi": wi, "wo": wo},
        (how.shade,),
        features(material),
        _uniforms(material),
        UNIFORMS,
    )[:, 0]
    theirs = oracle.sample_density(wi, wo, alpha, np.array(count))
    off = np.abs(ours - theirs) / np.maximum(theirs, 1e-4 * theirs.max())
    found.append(_made("densities", off.max(), f"{material.name}, alpha {alpha:.3g}"))
    return found


def _uniforms(material: Material) -> dict:
    return {
        "albedo": material.diffuse_albedo,
        "f0": material.specular_f0,
        "alpha": material.alpha,
        "weight_d": (material.weight, 1 - material.weight),
        "weight_g": (material.masking_weight, 1 - material.masking_weight),
    }
