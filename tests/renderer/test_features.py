"""Techniques by name, and what each asks for."""

from dataclasses import replace

import pytest

from renderer.features import features, split_samples
from renderer.techniques import WITHOUT, technique
from scenes.schema import PAPER, PHYSICAL, Maps, Material, Model, model_steps

COMPENSATED = Model(fresnel="exact", kd="conserving", masking="smith", multiscatter="on")


def test_known_techniques_have_their_names():
    for name in ("paper", "paper-noaa", "sampled", "split", "filtered"):
        assert technique(name).name == name
    assert technique("paper-noaa").msaa == 0 and technique("paper").msaa == 4


@pytest.mark.parametrize(
    ("name", "samples"), [("sampled@1", 1), ("sampled@65000", 65000), ("filtered@16", 16)]
)
def test_a_technique_that_samples_takes_a_number(name, samples):
    assert (technique(name).name, technique(name).samples) == (name, samples)


@pytest.mark.parametrize(
    "name",
    [
        "",
        "Paper",
        "sampled@",
        "sampled@0",
        "sampled@-1",
        "sampled@1.5",
        "paper@4",
        "sampled@65001",
        "sampled@9999999",
    ],
)
def test_other_names_are_refused_with_those_that_are_known(name):
    with pytest.raises(
        ValueError,
        match=r"known: paper, .*, best, sampled@N, filtered@N, shadowed@N, best@N with N up to",
    ):
        technique(name)


@pytest.mark.parametrize("idea", WITHOUT)
def test_best_can_be_drawn_without_each_of_its_ideas(idea):
    less = technique(f"best-without-{idea}")
    assert less.name == f"best-without-{idea}"
    assert replace(less, name="best") != technique("best")


def test_several_ideas_can_be_left_out():
    less = technique("best@16-without-rays-without-grid")
    assert (less.samples, less.grid, less.rays, less.occlusion) == (16, 1, False, True)


@pytest.mark.parametrize(
    "name", ["paper-noaa-without-antialiasing", "filtered-without-rays", "paper-without-irradiance"]
)
def test_what_a_technique_does_not_have_cannot_be_left_out(name):
    with pytest.raises(ValueError, match="to be without; some have antialiasing, grid"):
        technique(name)


def test_without_rays_narrow_lobes_read_what_is_baked(copper):
    mirror = copper(0.01)
    assert technique("best").incoming(mirror) == "incoming_traced.glsl"
    assert technique("best-without-rays").incoming(mirror) == "incoming_baked.glsl"


def test_an_idea_that_is_left_out_is_not_spared_for(copper):
    assert not technique("best-without-irradiance").spares(copper(0.2))
    assert technique("best-without-sharing").least_points(copper(0.5)) == technique("best").points


def test_only_what_a_material_needs_is_compiled_in(copper):
    assert features(copper(0.2, 1.0)) == {"D_GGX", "G_GGX"}
    assert features(copper(0.2, 0.0)) == {"D_BECKMANN", "G_BECKMANN"}
    assert features(copper(0.2, 1.0, weight_g=0.0)) == {"D_GGX", "G_BECKMANN"}
    plastic = Material(albedo=(0.0, 0.1, 0.0), roughness=0.5, metallic=0.0, weight=0.5)
    assert features(plastic) == {"D_GGX", "D_BECKMANN", "G_GGX", "G_BECKMANN", "DIFFUSE"}


@pytest.mark.parametrize("samples", [1, 2, 3, 4, 16, 64, 1023])
@pytest.mark.parametrize("weight", [0.0, 1e-7, 0.5, 1.0])
@pytest.mark.parametrize("albedo", [0.0, 1e-3, 1.0])
def test_samples_are_shared_out_whole(samples, weight, albedo):
    material = Material(albedo=(albedo,) * 3, roughness=0.5, metallic=0.0, weight=weight)
    split = split_samples(material, samples)
    needed = (weight > 0, weight < 1, albedo > 0)
    assert sum(split) == samples and min(split) >= 0
    assert not any(n and not need for n, need in zip(split, needed, strict=True))
    if samples >= 4:
        assert all(n > 0 for n, need in zip(split, needed, strict=True) if need)


def test_smiths_masking_takes_a_table_of_the_material_in_place_of_the_shared_ones(copper):
    smith = Model(masking="smith")
    assert features(copper(0.2), smith) == {"D_GGX", "G_GGX", "MASKING_SMITH"}
    paper, material = technique("paper"), copper(0.2, 0.5)
    shared, own = paper.maps(material), paper.maps(material, smith)
    assert set(shared) - set(own) == {"table_ggx", "table_beckmann"}
    assert paper.own_table(smith) and not paper.own_table(PAPER)
    assert not technique("sampled").own_table(smith)


@pytest.mark.parametrize("name", ["paper", "paper-noaa"])
def test_what_of_a_model_cannot_be_drawn_is_told(name):
    assert technique(name).cannot_draw(PAPER) == ""
    assert technique(name).cannot_draw(Model(masking="smith")) == ""
    assert technique(name).cannot_draw(model_steps(PAPER)[0]) == "fresnel = 'exact'"
    assert technique(name).cannot_draw(PHYSICAL) == "fresnel = 'exact', kd = 'interface'"
    assert technique(name).cannot_draw(Model(multiscatter="on")) == "multiscatter = 'on'"


@pytest.mark.parametrize("model", [PHYSICAL, COMPENSATED])
def test_samples_draw_every_model(model):
    assert technique("sampled@4").cannot_draw(model) == ""


def test_only_what_a_model_needs_of_a_material_is_compiled_in(copper):
    half = Material(albedo=(0.1,) * 3, roughness=0.5, metallic=0.5, metal="Cu", weight=1.0)
    lobe = {"D_GGX", "G_GGX"}
    assert features(half) == lobe | {"DIFFUSE"}
    assert features(copper(0.2), Model(fresnel="f82")) == lobe | {"FRESNEL_F82"}
    physical = lobe | {"MASKING_SMITH", "FRESNEL_METAL"}
    assert features(copper(0.2), PHYSICAL) == physical
    both = {"DIFFUSE", "FRESNEL_DIELECTRIC", "KD_INTERFACE"}
    assert features(half, PHYSICAL) == physical | both
    assert features(copper(0.2), COMPENSATED) == physical | {"MULTISCATTER"}
    kept = {"KD_CONSERVING", "MULTISCATTER"}
    assert features(half, COMPENSATED) == physical | both - {"KD_INTERFACE"} | kept


def test_light_off_many_facets_gets_samples_of_its_own(copper):
    assert split_samples(copper(0.2), 100)[2] == 0
    assert split_samples(copper(0.2), 100, COMPENSATED, spared=True)[2] == 5
    assert split_samples(copper(0.2), 100, COMPENSATED)[2] == 20


def test_cosine_samples_are_spared_where_an_even_lobe_is_known(copper):
    assert technique("best").spares(copper(0.2)) and technique("filtered").spares(copper(0.2))
    assert not technique("best").spares(copper(0.2), COMPENSATED)
    assert not technique("sampled").spares(copper(0.2))
    bumpy = copper(0.2).model_copy(update={"maps": Maps(normal="bumps.png")})
    assert not technique("best").spares(bumpy)
