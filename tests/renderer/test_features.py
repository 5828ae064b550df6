"""Techniques by name, and what each asks for."""

import pytest

from renderer.features import features, split_samples, technique
from scenes.schema import Material


def test_known_techniques_have_their_names():
    for name in ("paper", "paper-noaa", "sampled"):
        assert technique(name).name == name
    assert technique("paper-noaa").msaa == 0 and technique("paper").msaa == 4


@pytest.mark.parametrize(("name", "samples"), [("sampled@1", 1), ("sampled@4096", 4096)])
def test_sampled_takes_a_number(name, samples):
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
        "sampled@9999999",
    ],
)
def test_other_names_are_refused_with_those_that_are_known(name):
    with pytest.raises(ValueError, match="known: paper, paper-noaa, sampled, sampled@N"):
        technique(name)


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
