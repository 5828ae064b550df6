"""FORMAT.md: every example works, and every field is there."""

import json
import re
import tomllib

import pytest

from scenes.schema import Camera, Case, Environment, Material, Model, Object, Optics
from scenes.suite import (
    HERE,
    Budget,
    Run,
    Sampling,
    Scene,
    SceneObject,
    Suite,
    Sweep,
    expand,
    load_suite,
)

TEXT = (HERE / "FORMAT.md").read_text(encoding="utf-8")
BLOCKS = dict(re.findall(r"```(?:toml|json) (\w+)\n(.*?)```", TEXT, re.DOTALL))
WORDS = {w for span in re.findall(r"`([^`\n]+)`", TEXT) for w in re.findall(r"\w+", span)}


def test_there_is_an_example_of_every_kind():
    assert set(BLOCKS) == {"suite", "scene", "material", "case"}


def test_the_suite_example_works(tmp_path):
    (tmp_path / "suite.toml").write_text(BLOCKS["suite"], encoding="utf-8")
    ids = [e.case.id for e in expand(*load_suite(str(tmp_path / "suite.toml")))]
    assert len(ids) == 2 * 2 * 3
    assert "contact.studio.copper.weight=0.5" in ids and "contact.studio.copper.weight=0.5" in TEXT


def test_the_scene_and_material_examples_work(tmp_path):
    (tmp_path / "own.toml").write_text(BLOCKS["material"], encoding="utf-8")
    (tmp_path / "scene.toml").write_text(BLOCKS["scene"], encoding="utf-8")
    suite = tomllib.loads(BLOCKS["suite"])
    (tmp_path / "suite.toml").write_text(
        f'description = "d"\ntechniques = {suite["techniques"]}\ntruths = ["global"]\n'
        '[[run]]\nscene = "scene.toml"\nenvironments = ["studio"]\nmaterials = ["own.toml"]\n'
    )
    (entry,) = expand(*load_suite(str(tmp_path / "suite.toml")))
    ball, floor = entry.case.objects
    assert (ball.material.name, floor.material.name) == ("own", "white_plastic")
    assert Material(**tomllib.loads(BLOCKS["material"])).weight == 0.25


def test_the_case_example_is_what_a_candidate_is_given():
    case = Case.model_validate_json(BLOCKS["case"])
    assert json.loads(case.model_dump_json()) == json.loads(BLOCKS["case"])


@pytest.mark.parametrize(
    "kind",
    [
        Suite, Run, Sweep, Sampling, Budget, Scene, SceneObject,
        Case, Environment, Camera, Model, Object, Material, Optics,
    ],
    ids=lambda kind: kind.__name__,
)  # fmt: skip
def test_every_field_is_described(kind):
    assert set(kind.model_fields) - WORDS == set()


@pytest.mark.parametrize(
    "kind", [Sampling, Material, Camera, SceneObject], ids=lambda k: k.__name__
)
def test_defaults_that_are_numbers_are_told(kind):
    for name, field in kind.model_fields.items():
        if isinstance(field.default, int | float) and not isinstance(field.default, bool):
            rows = re.findall(rf"^\| `(?:camera\.)?{name}` \|.*$", TEXT, re.MULTILINE)
            assert any(f"| {field.default:g} |" in row for row in rows)
