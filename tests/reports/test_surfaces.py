"""Materials with a direction and maps: the two renderers beside each other, on small pictures."""

from functools import cache

import numpy as np
import pytest

from reference.truths import stage
from renderer.draw import Renderer
from renderer.techniques import technique
from reports.metrics.energy import block_sums
from scenes.schema import Camera, Case, Environment, Maps, Material, Object
from scenes.suite import HERE

IRON = {"metallic": 1.0, "metal": "Fe", "albedo": (1.0, 1.0, 1.0)}
PICTURES = {
    n: str(HERE / "textures" / f"worn_{n}.png") for n in ("albedo", "roughness", "metallic")
}
HAMMERED = str(HERE / "textures" / "hammered_normal.png")
BRUSHED = Material(roughness=0.4, anisotropy=0.8, rotation=20.0, weight=0.6, **IRON)
WORN = Material(roughness=1.0, maps=Maps(**PICTURES), **IRON)
HAMMER = Material(roughness=0.5, maps=Maps(normal=HAMMERED, repeat=0.5), **IRON)
BOTH = HAMMER.model_copy(update={"anisotropy": -0.6})
FADING = Material(roughness=0.8, maps=Maps(roughness="vertex", weight="vertex"), **IRON)
KNOT = str(HERE / "meshes" / "knot.ply")
NEAR = Camera(origin=(0, -6, 2), target=(0, 0, 0), fov=19)


def case(mesh, material, camera=NEAR, size=64, **placed):
    studio = Environment(name="courtyard", path=HERE / "environments" / "courtyard.exr")
    return Case(
        id="small", scene="small", environment=studio, camera=camera, width=size, height=size,
        objects=(Object(name="it", mesh=mesh, material=material, **placed),),
    )  # fmt: skip


@cache
def halves(case: Case) -> tuple[np.ndarray, ...]:
    """Two independent references, and the object at each pixel."""
    made = stage(case, "model")
    return *(made.trace(64, seed)["unoccluded"] for seed in (1, 2)), made.ids


def off(drawn: Case, traced: Case) -> tuple[float, float]:
    """Energy error and local energy, without the reference's noise, inside of the silhouette."""
    *both, ids = halves(traced)
    mask = ids == 1
    mask[1:-1, 1:-1] &= mask[:-2, 1:-1] & mask[2:, 1:-1] & mask[1:-1, :-2] & mask[1:-1, 2:]
    ours = Renderer(technique("sampled@1024"), repeats=0).render(drawn).rgb
    a, *b = (block_sums(p.mean(axis=2, keepdims=True), mask) for p in (ours, *both))
    mean = (b[0] + b[1]) / 2
    square = max(((a - b[0]) * (a - b[1])).mean(), 0)
    return float(a.sum() / mean.sum() - 1), float(np.sqrt(square / (mean**2).mean()))


CASES = {
    "brushed": (case("cylinder", BRUSHED), 0.008, 0.01),
    "brushed without texture coordinates": (
        case("sphere", BRUSHED, rotate=(40, 0, 20)), 0.008, 0.01
    ),
    "worn": (case("globe", WORN), 0.01, 0.015),
    "hammered": (case("globe", HAMMER), 0.01, 0.01),
    "hammered and brushed": (case("globe", BOTH), 0.01, 0.012),
    "fading": (case(KNOT, FADING, scale=0.3), 0.015, 0.025),
    "worn, from afar": (
        case("globe", WORN.model_copy(update={"maps": Maps(**PICTURES, repeat=6.0)})), 0.02, 0.06
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_both_renderers_draw_the_same_light(name):
    made, energy, local = CASES[name]
    found = off(made, made)
    assert abs(found[0]) < energy and found[1] < local


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("brushed", {"rotation": 30.0}),
        ("brushed", {"anisotropy": 0.7}),
        ("brushed without texture coordinates", {"rotation": 0.0}),
        ("worn", {"maps": Maps(**PICTURES | {"albedo": None})}),
        ("hammered", {"maps": Maps()}),
        ("fading", {"maps": Maps(roughness="vertex")}),
    ],
)
def test_a_wrong_direction_or_map_is_seen(name, changes):
    right, energy, local = CASES[name]
    (it,) = right.objects
    wrong = it.model_copy(update={"material": it.material.model_copy(update=changes)})
    found = off(right.model_copy(update={"objects": (wrong,)}), right)
    assert abs(found[0]) > energy or found[1] > local
