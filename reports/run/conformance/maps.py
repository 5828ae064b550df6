"""Irradiance and prefiltered maps, beside the integrals that they stand for."""

import numpy as np

from renderer.precompute import BASE, Precomputed, precomputed, prefilter
from renderer.program import bind_maps, program, set_uniforms
from reports.conformance import documented
from reports.conformance.kernels import lambert, reflected
from reports.conformance.light import Light, direction
from reports.conformance.result import Conformance
from reports.conformance.textures import trilinear
from reports.run.conformance.shared import filled, levels_of, measured, relative, texels_of
from reports.stability import oracle
from scenes.environment import load_environment
from scenes.schema import ALPHA_MIN, Environment

PLACES = 16  # of a map that are looked at; fewer where the light has more cells
AFFORDED, FEWEST_PLACES = 40_000, 6
QUIETER = 0.25  # a map's samples are regular and filtered: a quarter of random ones' noise, at most
LOBES = {"ggx": oracle.D_ggx, "beckmann": oracle.D_beckmann}


def of_maps(made: Precomputed, light: Light, names: set[str], place_of: str) -> list[Conformance]:
    """The irradiance map and the prefiltered ones, at some of their texels."""
    maps = made.maps
    found = []
    if "irradiance_map" in names:
        texels = texels_of(maps["irradiance_map"])
        rows, columns, axes = _some(texels, light)
        (E,), _, _ = light.convolved(axes, [lambert])
        off = relative(texels[rows, columns, :3], E)
        found.append(measured("irradiance map", off, place_of))
    wanted = sorted(n for n in names if n.startswith("prefiltered"))
    for level in range(prefilter.LEVELS) if wanted else ():
        alpha = max((level / (prefilter.LEVELS - 1)) ** 2, ALPHA_MIN)
        levels = {n: texels_of(maps[n], level) for n in wanted}
        rows, columns, axes = _some(next(iter(levels.values())), light)
        if level == 0:
            theirs = _mirrored(levels_of(maps), light, axes, prefilter.SIZE)
            for name, texels in levels.items():
                mean = texels[rows, columns, :3] / texels[rows, columns, 3:]
                found.append(
                    measured("mirror's map", relative(mean, theirs), f"{name} of {place_of}")
                )
            continue
        kernels = [reflected(LOBES[n.removeprefix("prefiltered_")], alpha) for n in wanted]
        for name, *theirs in zip(wanted, *light.convolved(axes, kernels), strict=True):
            ours = levels[name][rows, columns].astype(float)
            off, noise = _sampled_off(ours, *theirs)
            place = f"{name}, level {level}, of {place_of}"
            found.append(measured("prefiltered maps", off - QUIETER * noise, place))
            off = relative(ours[:, 3], theirs[1])
            found.append(measured("prefiltered weights", off, place))
    return found


def of_sizes(made: Precomputed, names: set[str]) -> list[Conformance]:
    """How many of a map's width, height and levels are not what the technique is said to take."""
    found = []
    for name in sorted(names & documented.SIZES.keys()):
        size, wanted = [made.maps[name].width, made.maps[name].height], [*documented.SIZES[name]]
        if name.startswith("prefiltered"):
            size, wanted = [*size, prefilter.LEVELS], [*wanted, documented.LEVELS]
        other = sum(a != b for a, b in zip(size, wanted, strict=True))
        found.append(measured("sizes of maps", other, f"{name}, {'x'.join(map(str, size))}"))
    return found


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
    sums = filled(shader, size)
    y, x = (np.indices(size[::-1]).reshape(2, -1) + 0.5) / np.array(size[::-1])[:, None]
    theirs = _mirrored(levels_of(maps), light, direction(np.stack([x, y], 1)), size)
    place = f"a coarse one of {environment.name}"
    return measured("mirror's map", relative(sums[:, :3] / sums[:, 3:], theirs), place)


def _mirrored(
    levels: list[np.ndarray], light: Light, axes: np.ndarray, size: tuple[int, int]
) -> np.ndarray:
    """The light over texels of a map of `size` (width, height), (n, 3)."""
    sine = np.maximum(np.hypot(axes[:, 0], axes[:, 1]), 0.5 / size[1])
    lod = light.level(axes, 2 * np.pi**2 * sine / (size[0] * size[1]))
    return trilinear(levels, light.place(axes), lod)


def _sampled_off(
    ours: np.ndarray, sums: np.ndarray, alone: np.ndarray, squares: np.ndarray
) -> tuple[float, float]:
    """How far the radiance that a map stores is off, and how far random samples would be.

    The map's own samples are regular and filtered, so that they do better.
    """
    size = np.sqrt((sums**2).mean())
    spread = np.sqrt(np.maximum(squares - sums**2, 0).mean() / documented.POINTS)
    return relative(ours[:, :3], sums), float(spread / max(size, 1e-30))


def _some(texels: np.ndarray, light: Light) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows, columns and directions of some texels of a lat-long map, all corners among them."""
    height, width = texels.shape[:2]
    count = max(int(PLACES * min(AFFORDED / light.cells, 1)), FEWEST_PLACES)
    rng = np.random.default_rng(height)
    rows = np.concatenate([[0, 0, height - 1, height - 1], rng.integers(0, height, count - 4)])
    columns = np.concatenate([[0, width - 1] * 2, rng.integers(0, width, count - 4)])
    uv = np.stack([(columns + 0.5) / width, (rows + 0.5) / height], 1)
    return rows, columns, direction(uv)
