"""Materials, cameras and cases: what is allowed and what it becomes."""

import math

import numpy as np
import pytest
from pydantic import ValidationError

from scenes.optics import load_constants
from scenes.schema import ALPHA_MIN, PAPER, PHYSICAL, Camera, Case, Material, Model, model_steps
from scenes.suite import expand, load_suite

METAL = {"roughness": 0.5, "metallic": 1.0, "metal": "Cu"}
PLASTIC = {"roughness": 0.5, "metallic": 0.0, "albedo": (0.8, 0.4, 0.2)}


def test_alpha_is_roughness_squared_with_a_floor():
    assert Material(**METAL | {"roughness": 0.3}).alpha == pytest.approx(0.09)
    assert Material(**METAL | {"roughness": 0.0}).alpha == ALPHA_MIN


def test_named_metal_brings_its_constants():
    copper = Material(**METAL)
    assert list(copper.specular_f0) == load_constants()["Cu"]["f0"]
    assert list(copper.metal.eta) == load_constants()["Cu"]["eta"]
    assert copper.diffuse_albedo == (0, 0, 0)


def test_half_a_metal_mixes_f0_and_albedo():
    half = Material(**METAL | PLASTIC | {"metallic": 0.25, "f0": 0.04})
    metal = np.array(load_constants()["Cu"]["f0"])
    np.testing.assert_allclose(half.specular_f0, 0.75 * 0.04 + 0.25 * metal)
    np.testing.assert_allclose(half.diffuse_albedo, 0.75 * np.array(PLASTIC["albedo"]))


def test_a_bare_f0_of_a_dielectric_gives_the_eta_that_reflects_so_much():
    eta = np.array(Material(**PLASTIC, f0=(0.04, 0.02, 0.0)).f0.eta)
    np.testing.assert_allclose(((eta - 1) / (eta + 1)) ** 2, (0.04, 0.02, 0.0), atol=1e-15)


def test_a_bare_f0_of_a_metal_has_no_eta():
    assert Material(**METAL | {"metal": (0.9, 0.6, 0.5)}).metal.eta is None


def test_weight_g_follows_weight_unless_given():
    assert Material(**METAL, weight=0.3).masking_weight == 0.3
    assert Material(**METAL, weight=0.3, weight_g=0.8).masking_weight == 0.8


@pytest.mark.parametrize(
    "pair", [(0.3, 0.7), [0.3, 0.7], np.array([0.3, 0.7]), (0.3, 0.7 + 1e-9)], ids=str
)
def test_a_pair_of_weights_is_its_ggx_share(pair):
    assert Material(**METAL, weight=pair).weight == 0.3


@pytest.mark.parametrize("weight", [0.25, np.float64(0.25), np.float32(0.25)], ids=repr)
def test_a_weight_may_be_a_numpy_number(weight):
    assert Material(**METAL, weight=weight).weight == 0.25


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("weight", 1.5),
        ("weight", -0.1),
        ("weight", math.nan),
        ("weight", (0.6, 0.6)),
        ("weight", (1.2, -0.2)),
        ("weight", (0.5, 0.3, 0.2)),
        ("weight", (math.nan, math.nan)),
        ("weight", (True, False)),
        ("roughness", "0.2"),
        ("metallic", True),
        ("weight_g", (0.2, 0.2)),
        ("roughness", 1.01),
        ("roughness", math.inf),
        ("metallic", -1),
        ("albedo", (0.5, 0.5, 1.5)),
        ("albedo", (0.5, 0.5)),
        ("f0", (2, 0, 0)),
        ("f0", "Cu"),
        ("metal", "acrylic"),
        ("metal", {"f0": (1, 1, 1), "eta": (0, 1, 1), "k": (1, 1, 1)}),
        ("colour", "red"),
    ],
    ids=str,
)
def test_what_leaves_its_range_is_refused(field, value):
    with pytest.raises(ValidationError, match=field):
        Material(**METAL | PLASTIC | {field: value})


def test_metal_needs_its_optics_and_plastic_its_albedo():
    with pytest.raises(ValidationError, match="without a metal"):
        Material(roughness=0.5, metallic=0.5, albedo=(0, 0, 0))
    with pytest.raises(ValidationError, match="without an albedo"):
        Material(roughness=0.5, metallic=0.5, metal="Cu")


@pytest.mark.parametrize("target", [(0, 0, 0), (0, 0, 5)], ids=["itself", "along up"])
def test_a_camera_must_look_somewhere_beside_up(target):
    with pytest.raises(ValidationError, match="one line"):
        Camera(origin=(0, 0, 0), target=target, fov=30)


def test_a_pixel_must_be_wider_than_float32_rays_are_apart():
    """2^-16 radians are 256 steps of 2^-24, the last digit of a direction."""
    fields = expand(*load_suite("tiny"))[0].case.model_dump()
    least = math.degrees(2**-16) * fields["height"]
    Case.model_validate(fields | {"camera": fields["camera"] | {"fov": least * 1.0001}})
    with pytest.raises(ValidationError, match="finer than float32 rays"):
        Case.model_validate(fields | {"camera": fields["camera"] | {"fov": least * 0.9999}})


@pytest.mark.parametrize("suite", ["default", "spheres", "full", "tiny", "bench"])
def test_every_case_survives_json(suite):
    for entry in expand(*load_suite(suite)):
        assert Case.model_validate_json(entry.case.model_dump_json()) == entry.case


def test_a_case_refuses_two_objects_of_one_name():
    case = expand(*load_suite("tiny"))[0].case
    fields = case.model_dump() | {"objects": [case.objects[0].model_dump()] * 2}
    with pytest.raises(ValidationError, match="share the name"):
        Case.model_validate(fields)


def test_the_papers_model_becomes_physical_by_fresnel_then_kd_then_masking():
    before, changed = PAPER, []
    for model in model_steps(PAPER):
        (field,) = (f for f in Model.model_fields if getattr(model, f) != getattr(before, f))
        changed.append(field)
        before = model
    assert changed == ["fresnel", "kd", "masking"]
    assert before == PHYSICAL


def test_what_is_physical_already_makes_a_step_that_changes_nothing():
    assert model_steps(PHYSICAL) == [PHYSICAL] * 3
    fresnel, kd, masking = model_steps(Model(masking="smith"))
    assert fresnel == Model(fresnel="exact", masking="smith")
    assert kd == masking == PHYSICAL


def test_an_interface_under_schlicks_fresnel_is_refused():
    with pytest.raises(ValidationError, match="add fresnel = 'exact'"):
        Model(kd="interface")
