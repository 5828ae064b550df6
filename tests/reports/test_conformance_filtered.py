"""Conformance of `filtered` and `split` holds, and sees faults in every file of theirs."""

import pytest

from renderer import precompute
from renderer.precompute import blurred, split
from renderer.program import program
from renderer.techniques import technique
from reports.run.conformance.filtered import (
    of_filtered_light,
    of_filtered_samples,
    of_taken_out,
)
from reports.run.conformance.split import of_better_split_sum, of_split_maps, of_split_table
from scenes.schema import Environment, Material, Model
from scenes.suite import HERE

PLASTIC = Material(name="plastic", albedo=(0.6, 0.3, 0.05), roughness=0.4, metallic=0.0, weight=0.5)
COPPER = Material(name="copper", roughness=0.4, metallic=1.0, metal="Cu", weight=0.5)
LAMPS = Environment(name="lamps", path=HERE / "suites" / "guard" / "lamps.exr", rotation=40.0)
FILTERED, SPLIT = technique("filtered"), technique("split")


@pytest.fixture(autouse=True)
def _made_anew():
    """Programs and maps of a broken shader must not outlive the test."""
    caches = program, precompute._cached, blurred._made, split._tables
    for cache in caches:
        cache.cache_clear()
    yield
    for cache in caches:
        cache.cache_clear()


def tables():
    names = [f"{what}_{lobe}" for what in ("albedo", "towards") for lobe in ("ggx", "beckmann")]
    return [of_split_table(name, LAMPS) for name in names]


def better_split_sums():
    surfaces = [(PLASTIC, "paper"), (COPPER, "paper"), (PLASTIC, "smith")]
    return [of_better_split_sum(LAMPS, m, Model(masking=g), SPLIT) for m, g in surfaces]


CHECKS = {
    "samples": lambda: of_filtered_samples(PLASTIC, FILTERED),
    "densities": lambda: of_filtered_samples(PLASTIC, FILTERED),
    "power of lights": lambda: of_taken_out(LAMPS),
    "blurred levels": lambda: of_taken_out(LAMPS),
    "filtered light": lambda: [
        f for m in (PLASTIC, COPPER) for f in of_filtered_light(LAMPS, m, Model(), FILTERED)
    ],
    "irradiance map": lambda: of_split_maps(LAMPS, {"irradiance_exact"}),
    "lobes": lambda: of_split_maps(LAMPS, {"lobe_ggx"}),
    "tables": tables,
    "better split sum": better_split_sums,
}


def failed(name: str) -> bool:
    return any(not f.passed for f in CHECKS[name]() if f.name == name)


@pytest.mark.parametrize("name", CHECKS)
def test_the_renderer_as_it_is_conforms(name):
    found = [f for f in CHECKS[name]() if f.name == name]
    assert found and not [f for f in found if not f.passed]


@pytest.mark.parametrize(
    ("file", "right", "wrong", "seen"),
    [
        ("sample_visible_ggx.glsl", "r = max(1.0 - u.x", "r = max(0.99 - u.x", "samples"),
        ("sample_visible_ggx.glsl", "4.0 * (1.0 - a)", "3.9 * (1.0 - a)", "densities"),
        ("sample_visible_ggx.glsl", "* G1_ggx(wo, alpha)", "", "densities"),
        ("spiral.glsl", "0.618033988749895", "0.61", "samples"),
        ("shade_filtered.glsl", "wi.z * INV_PI", "wi.z * 0.3", "densities"),
        ("shade_filtered.glsl", "wi.z / density *", "0.9 / density *", "filtered light"),
        ("shade_filtered.glsl", "sent = share * ", "sent = ", "filtered light"),
        ("shade_filtered.glsl", "sky_lod()) - share)", "sky_lod()))", "filtered light"),
        ("sky.glsl", "return polar_map", "return 0.9 * polar_map", "filtered light"),
        ("shade_filtered.glsl", "L += lights(", "L += 0.0 * lights(", "filtered light"),
        ("light_visibility.glsl", "return 1.0;", "return 0.5;", "filtered light"),
        ("lights.glsl", "+ 1.0, 0.0, 1.0)", "+ 3.0, 0.0, 1.0)", "filtered light"),
        ("environment.glsl", "radiance_uv(world)", "radiance_uv(-world)", "filtered light"),
        ("view_frame.glsl", "cross(y, n), y, n)", "cross(y, n), n, y)", "filtered light"),
        ("blurred.frag", "2.0 - x : 1.0", "1.0 : 1.0", "blurred levels"),
        ("blurred.frag", "SPREAD = 0.25", "SPREAD = 0.4", "blurred levels"),
        ("lobe_map.frag", "0.25 * D * wi.z", "0.25 * D", "lobes"),
        ("lobe_map.frag", "k.x * light_irradiance", "0.0 * light_irradiance", "lobes"),
        ("lobe_map.frag", "layers + 1.0) * 0.5", "layers + 1.5) * 0.5", "lobes"),
        ("lobe_table.frag", "G1_ggx(wo, alpha) * tail", "tail", "tables"),
        ("lobe_table.frag", "wi.xzxz", "wi.xzzx", "tables"),
        ("irradiance_exact.frag", "sum += z *", "sum += 0.9 * z *", "irradiance map"),
        ("irradiance_exact.frag", "PI / float(count)", "3.0 / float(count)", "irradiance map"),
        ("diffuse_share.glsl", "7.797185e-3", "7.797185e-2", "better split sum"),
        ("shade_split.glsl", "* m.albedo * INV_PI", "* INV_PI", "better split sum"),
        ("shade_split.glsl", "2.0 * log2(alpha)", "1.9 * log2(alpha)", "better split sum"),
        ("shade_split.glsl", "seen.towards.x, 0.0", "0.0, 0.0", "better split sum"),
        ("shade_split.glsl", "0.5), 0.0).xy", "0.5), 0.0).yx", "better split sum"),
    ],
)  # fmt: skip
def test_a_fault_is_seen(broken, file, right, wrong, seen):
    broken(file, right, wrong)
    assert failed(seen)
