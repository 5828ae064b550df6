"""What shaders look up: levels of the light's map, and the split sum's table."""

from collections.abc import Iterator

import numpy as np

from renderer.context import context
from renderer.precompute import brdf_table
from renderer.probe import probe
from renderer.targets import release
from reports.furnace import Surface, furnace_albedo
from reports.run.stability.geometry import POLAR
from reports.stability import oracle
from reports.stability.directions import MASKINGS
from reports.stability.grid import WEIGHTS, axis, spread, unit
from reports.stability.maps import make_map
from reports.stability.results import Map
from scenes.schema import Material

LEVEL = 1e-3  # of one level of mips
TABLE = 0.005  # what 1,024 points may add to a surface that loses nothing
SIZES = ((1, 1), (2, 1), (1, 2), (7, 5), (512, 256))


def maps() -> Iterator[Map]:
    """Every look-up."""
    yield radiance_lod()
    yield from tables()


def radiance_lod() -> Map:
    """The level of a sample against float64, for maps of every shape."""
    sizes = axis("size of the map", range(len(SIZES)))
    polar = axis("polar angle", POLAR.values)
    densities = axis("density", [1e-30, *10.0 ** np.arange(-6, 13, 2), 3e38], log=True)
    angle, density = spread(polar.values, densities.values, 1)
    w = unit(np.cos(angle), 0.3 + 0 * angle, np.sin(angle)).astype(np.float32)
    density = density.astype(np.float32)
    figures = []
    for size in SIZES:
        found, expected = level(size, w, density)
        off = np.abs(found - expected)
        off[~np.isfinite(found) | (found < 0)] = np.inf
        figures.append(off.reshape(len(polar.values), len(densities.values), 1))
    return make_map(
        "radiance_lod",
        "against float64",
        np.stack(figures),
        (sizes, polar, densities),
        lambda at: [
            {
                "size": SIZES[at[0]],
                "w": w[at[1] * len(densities.values) + at[2]],
                "density": density[at[1] * len(densities.values) + at[2]],
            }
        ],
        why="A level that is no number reads no light. Sizes: 1x1, 2x1, 1x2, 7x5, 512x256.",
        unit="levels; infinite for one that is negative or no number",
        limit=LEVEL,
    )


def level(
    size: tuple[int, int], w: np.ndarray, density: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """radiance_lod in GLSL and in float64, both (n,), for a map of this width and height."""
    width, height = map(int, size)
    texture = context().texture((width, height), 4, dtype="f4")
    found = probe(
        "vec4(radiance_lod(w.xyz, d.x, 1.0))",
        {"w": w, "d": density},
        ("radiance.glsl",),
        maps={"radiance_map": texture},
    )[:, 0]
    release(texture)
    return found, oracle.mip_level((width, height), w.astype(float), 1 / density.astype(float))


def split_sum(
    cosine: float, roughness: float, weight: float, masking: str
) -> tuple[np.ndarray, np.ndarray]:
    """Scale and bias of the texel that holds n.v and roughness, from the table and in float64."""
    i, j = (min(int(x * 128), 127) for x in (cosine, roughness))
    return _looked_up([i], [j], weight, masking)[0, 0], _integrated([i], [j], weight, masking)[0, 0]


def tables() -> Iterator[Map]:
    """The split sum's scale and bias for F0, as they are looked up, against furnaces in float64."""
    every = [0, 1, 3, 7, 15, 31, 63, 95, 127]
    centre = _centres(every)
    axes = (axis("weight", WEIGHTS), axis("n.v", centre), axis("roughness", centre))
    for masking in MASKINGS:
        found, truth = (
            np.stack([side(every, every, float(w), masking) for w in WEIGHTS])
            for side in (_looked_up, _integrated)
        )

        def reproduce(at, masking=masking):
            cell = {"n.v": centre[at[1]], "roughness": centre[at[2]], "weight": WEIGHTS[at[0]]}
            return [cell | {"masking": masking}]

        yield make_map(
            "scale_bias",
            "against float64",
            np.abs(found - truth).max(axis=-1)[..., None],
            axes,
            reproduce,
            masking=masking,
            why="What 1,024 points leave, most where n.v grazes: an error of the technique, which "
            "frames are judged by, reported as it is.",
            unit="difference of scale or bias, as a share of all light",
        )
        light = np.where((found < 0).any(axis=-1), -1, found.sum(axis=-1))
        yield make_map(
            "scale_bias",
            "white furnace",
            light[..., None],
            axes,
            reproduce,
            masking=masking,
            why="Scale and bias are shares of light that one reflection sends back: neither is "
            "negative, and together they are at most 1, also in the table's first and last texels.",
            unit="scale + bias; at most 1",
            at_least=0.0,
            limit=1 + TABLE,
            centre=0.0,
        )


def _centres(texels: list[int]) -> np.ndarray:
    return (np.array(texels) + 0.5) / 128


def _looked_up(columns: list[int], rows: list[int], weight: float, masking: str) -> np.ndarray:
    """Scale and bias in texels, (columns, rows, 2), mixed as the shader does."""
    if masking == "smith":
        kinds = [
            Material(roughness=float(r), metallic=1.0, metal=1.0, weight=weight)
            for r in _centres(rows)
        ]
        tables = [_texels(brdf_table.smith_table(k).texture)[0, columns, :2] for k in kinds]
        return np.stack(tables, axis=1)
    shared = brdf_table.make(None, ("table_ggx", "table_beckmann"))
    ggx, beckmann = (_texels(t)[np.ix_(rows, columns)].swapaxes(0, 1) for t in shared.values())
    sums = weight * ggx + (1 - weight) * beckmann
    return weight * sums[..., :2] + (1 - weight) * sums[..., 2:]


def _integrated(columns: list[int], rows: list[int], weight: float, masking: str) -> np.ndarray:
    """The same in double precision: F0 = 1 reflects scale + bias, and F0 = 0 bias."""
    found = np.empty((len(columns), len(rows), 2))
    for j, r in enumerate(_centres(rows)):
        surface = Surface((r * r, r * r), np.array([weight]), masking)
        for i, c in enumerate(_centres(columns)):
            both, bias = furnace_albedo(surface, float(np.arccos(c)), (1.0, 0.0))[:, 0]
            found[i, j] = both - bias, bias
    return found


def _texels(texture) -> np.ndarray:
    return np.frombuffer(texture.read(), np.float32).reshape(texture.height, texture.width, 4)
