"""A BRDF from outside, checked direction by direction, and its mistakes named."""

import sys

import pytest

PROGRAM = """
import json, sys
import numpy as np
from reports.stability.models import model_brdf
from scenes.schema import Material, Model
asked = json.load(open(sys.argv[1]))
material, model = Material(**asked["material"]), Model(**asked["model"])
wi, wo = (np.array(asked[n], np.float32) for n in ("wi", "wo"))
f = model_brdf(material, wi, wo, model)
{change}
json.dump(f.tolist(), open(sys.argv[2], "w"))
"""
ROUGHER = """
rougher = material.model_copy(update={"roughness": material.roughness**0.5})
f = model_brdf(rougher, wi, wo, model)
"""


@pytest.fixture
def ask(shadeproof, tmp_path):
    def asked(change="", *words):
        program = tmp_path / "f.py"
        program.write_text(PROGRAM.replace("{change}", change))
        command = f"{sys.executable} {program} {{case}} {{out}}"
        given = words or ("--material", "copper", "--material", "red_plastic")
        return shadeproof("brdf", "--candidate", command, *given)

    return asked


def test_the_right_values_pass(ask):
    code, out, err = ask()
    assert code == 0 and out.count(": right") == 2, out + err


def test_the_usual_materials_cover_alpha_and_weight(ask):
    code, out, _ = ask("", "--model", "paper")
    assert code == 0 and out.count(": right") == 20


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ("f = f * wi[:, 2:]", "holds the cosine"),
        ("f = f * np.pi", "pi times too large"),
        ("f = f / np.pi", "by pi too small"),
        (ROUGHER, "roughness is used as alpha"),
        ("f = f[:, ::-1]", "red and blue are exchanged"),
    ],
)
def test_a_mistake_is_named(ask, change, told):
    code, out, _ = ask(change)
    assert code == 1 and "off, by" in out and told in out


def test_a_difference_that_nothing_explains_is_just_told(ask):
    code, out, _ = ask("f = f * (1 + 0.1 * wi[:, :1])")
    assert code == 1 and "it looks as if" not in out


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ("f = f[:-1]", "wrote values of shape"),
        ('f = np.array(["x"])', "wrote no list"),
        ("sys.exit(3)", "exit code 3"),
        ("f[0] = np.nan", "off, by inf"),
    ],
)
def test_what_is_no_answer_is_told_in_one_line(ask, change, told):
    code, out, err = ask(change)
    assert code in (1, 2) and told in out + err and "Traceback" not in err


def test_a_folder_is_no_brdf(shadeproof, tmp_path):
    (tmp_path / "a.exr").touch()
    assert shadeproof("brdf", "--candidate", tmp_path)[0] == 2
