"""Blender's Cycles as a second opinion: what it is told, and what is not asked of it."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

from reports.crosscheck.displays import colourfulness, reinhard
from reports.crosscheck.export import (
    cycles_material,
    environment_mapping,
    write_scene,
)
from reports.crosscheck.masking import conductor, correlated_over_separable
from scenes.environment import load_environment
from scenes.errors import InputError
from scenes.schema import Material, Object
from scenes.suite import expand, load_suite

ROOT = Path(__file__).parents[2]
BLENDER = ROOT / ".venv-crosscheck/bin/python"
COPPER = Material(metal="Cu", roughness=0.5, metallic=1.0)


def suite_case(name: str):
    return next(e.case for e in expand(*load_suite("crosscheck")) if e.case.id == name)


def ball(**material) -> Object:
    return Object(name="ball", mesh="sphere", material=Material(**material))


def test_rows_of_the_environment_stay_where_both_renderers_have_them():
    mapping, rows = environment_mapping(5, 90.0), np.arange(5)
    v = 1 - (np.pi * rows / 4 * mapping["scale"] + mapping["offset"])
    assert v == pytest.approx(1 - (rows + 0.5) / 5)
    assert mapping["turn"] == 0.25  # of FORMAT.md's u = phi / 360 + rotation / 360


@pytest.mark.parametrize(
    ("material", "kind"),
    [
        ({"albedo": [0.5] * 3, "f0": 2.5e-9, "roughness": 0.0, "metallic": 0.0}, "diffuse"),
        ({"albedo": [0.5] * 3, "f0": 0.04, "roughness": 0.5, "metallic": 0.0}, "principled"),
        ({"metal": "Cu", "roughness": 0.5, "metallic": 1.0}, "conductor"),
        ({"metal": [0.9, 0.6, 0.5], "roughness": 0.5, "metallic": 1.0}, "schlick"),
    ],
)
def test_each_material_goes_to_the_surface_that_means_the_same(material, kind):
    assert cycles_material(ball(**material))["kind"] == kind


def test_a_metal_keeps_its_alpha_its_constants_and_its_lobe():
    made = cycles_material(ball(metal="Cu", roughness=0.5, metallic=1.0, weight=0.0))
    assert made["alpha"] == 0.25
    assert made["distribution"] == "BECKMANN"
    assert (made["eta"], made["k"]) == (COPPER.metal.eta, COPPER.metal.k)


@pytest.mark.parametrize(
    ("changed", "field"),
    [
        ({"weight": 0.5}, "weight"),
        ({"weight_g": 0.0}, "weight"),
        ({"metallic": 0.5}, "metallic"),
        ({"metallic": 0.0, "weight": 0.0}, "weight"),
        ({"metallic": 0.0, "f0": 1.0}, "f0"),
    ],
)
def test_what_cycles_has_no_surface_for_is_refused(changed, field):
    material = {"albedo": [0.5] * 3, "metal": "Cu", "roughness": 0.5, "metallic": 1.0}
    with pytest.raises(InputError, match=f"material.{field}"):
        cycles_material(ball(**material | changed))


def test_the_command_refuses_in_one_line(tmp_path):
    case = suite_case("crosscheck.courtyard.copper").model_dump(mode="json")
    case["objects"][0]["material"]["weight"] = 0.5
    (tmp_path / "case.json").write_text(json.dumps(case))
    words = [sys.executable, "-m", "reports.crosscheck", "/no/python"]
    words += [tmp_path / "case.json", tmp_path / "out.exr"]
    ran = subprocess.run(words, capture_output=True, text=True, cwd=ROOT)
    assert ran.returncode == 2
    assert ran.stderr.count("\n") == 1 and "mixes GGX and Beckmann" in ran.stderr


def test_blender_reads_the_very_arrays_of_the_reference(tmp_path):
    case = suite_case("crosscheck.courtyard.lambert")
    write_scene(case, tmp_path)
    arrays = np.load(tmp_path / "scene.npz")
    radiance = load_environment(case.environment.path).radiance
    assert arrays["environment"].tobytes() == radiance.tobytes()
    assert arrays["vertices_1"].shape == arrays["normals_1"].shape
    assert arrays["vertices_1"].dtype == np.float32


def test_masking_makes_no_difference_to_who_looks_along_the_normal():
    up, nearly_up = np.tile([0.0, 0, 1], (8, 1)), np.tile([1e-9, 0, 1], (8, 1))
    assert correlated_over_separable(COPPER, up, nearly_up, None) == pytest.approx(0, abs=1e-12)


def test_correlated_masking_is_the_brighter_the_rougher_the_metal():
    up, aslant = np.tile([0.0, 0, 1], (64, 1)), np.tile([0.8, 0, 0.6], (64, 1))
    gaps = [
        correlated_over_separable(COPPER.model_copy(update={"roughness": r}), up, aslant, None)
        for r in (0.1, 0.5, 1.0)
    ]
    assert 0 <= gaps[0] < 1e-4 < gaps[1] < 0.05 < gaps[2]


def test_a_conductor_reflects_f0_head_on_and_everything_at_the_horizon():
    head_on, grazing = conductor(np.array([1.0, 0.0]), COPPER)
    assert head_on == pytest.approx(COPPER.metal.f0, abs=1e-5)
    assert grazing == pytest.approx(1)


def test_colourfulness_of_pure_red_and_of_grey():
    red = colourfulness(np.array([[1.0, 0, 0]]))
    assert red["chroma"] == pytest.approx(104.55, abs=0.05)  # CIELAB, D65
    assert red["saturation"] == 1
    assert red["luminance"] == pytest.approx(0.2126)
    assert colourfulness(np.full((3, 3), 0.5))["chroma"] == pytest.approx(0, abs=0.01)
    assert reinhard(np.array([1.0])) == pytest.approx(0.5 ** (1 / 2.2))


def test_blender_is_pinned_as_the_extra_says():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extra = project["optional-dependencies"]["crosscheck"][0].split(";")[0]
    assert f"\n{extra} \\\n" in (ROOT / "requirements/crosscheck.txt").read_text()
    assert f"\n{extra}\n" in (ROOT / "requirements/crosscheck.in").read_text()


@pytest.mark.long
@pytest.mark.skipif(not BLENDER.exists(), reason="no Blender; `make crosscheck` installs it")
def test_cycles_and_mitsuba_agree_on_lambert_and_on_the_background(shadeproof, tmp_path):
    candidate = f"{sys.executable} -m reports.crosscheck {BLENDER} {{case}} {{out}} --samples 64"
    words = ["--suite", "crosscheck", "--filter", "courtyard.lambert", "--candidate", candidate]
    code, out, err = shadeproof("compare", *words, "--out", tmp_path, "--json")
    assert code == 0, err
    for row in json.loads(out)["rows"]:
        assert row["problem"] == ""
        assert abs(row["energy_error"]) < 0.005
        assert row["energy_local"] < 0.01
