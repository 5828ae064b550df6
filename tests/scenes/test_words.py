"""No refusal speaks of the library that found the mistake."""

import copy
import datetime
from pathlib import Path

import pytest

from scenes.errors import InputError
from scenes.files import parse
from scenes.schema import Material
from scenes.suite import Scene, Suite
from scenes.words import nearest

EVERY_FIELD = {
    Suite: {
        "description": "all that a suite can say",
        "techniques": ["paper"],
        "truths": ["global"],
        "allow_inconclusive": False,
        "model": {"fresnel": "exact", "kd": "interface", "masking": "paper", "multiscatter": "off"},
        "reference": {"samples_per_batch": 4, "max_samples": 64},
        "run": [
            {
                "scene": "bunnies",
                "environments": ["studio"],
                "rotation": 0.0,
                "materials": ["copper"],
                "sweep": {"weight": [0.5], "roughness": [0.5], "metallic": [0.5]},
                "resolution": [4, 4],
                "truths": ["global"],
                "techniques": ["paper"],
                "split_model": False,
            }
        ],
        "budget": [
            {"technique": "paper", "truth": "global", "reason": "a test", "weight": 0.5}
            | dict.fromkeys(("scene", "environment", "object", "material"), "x")
            | dict.fromkeys(("energy_error", "energy_local", "ssim", "silhouette"), 0.5)
        ],
    },
    Scene: {
        "description": "all that a scene can say",
        "resolution": [4, 4],
        "camera": {"origin": [0, 0, 1], "target": [0, 1, 0], "up": [0, 0, 1], "fov": 30},
        "object": [
            {"name": "one", "mesh": "sphere", "material": "copper", "scale": 1.0, "height": 1.0}
            | {"position": [0, 0, 0], "rotate": [0, 0, 0], "judged": True, "fixed": True},
            {"name": "two", "mesh": "plane", "material": {"use": "copper"}, "scale": [1, 1, 1]},
        ],
    },
    Material: {
        "albedo": [0.1, 0.1, 0.1],
        "roughness": 0.5,
        "metallic": 0.5,
        "f0": 0.04,
        "metal": [0.5, 0.5, 0.5],
        "weight": 0.5,
        "weight_g": [0.5, 0.5],
        "anisotropy": 0.5,
        "rotation": 30,
        "maps": {"roughness": "vertex", "repeat": 2},
    },
}
WRONG = ["word", "", True, 3, -3, 10**9, 2.5, float("nan"), float("inf"), datetime.date.today()]
WRONG += [[], [1], [1] * 300, ["x", "x"], [[]], [{}], [True], {}, {"unknown": 1}]
JARGON = ("Input", "input", "valid", "tuple", "instance", "dictionary", "True", "datetime")


def places(value, place=()):
    """Where every field and item of a file's fields stands."""
    if not isinstance(value, dict | list):
        return
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
        yield (*place, key)
        yield from places(inner, (*place, key))


@pytest.mark.parametrize("kind", EVERY_FIELD)
def test_every_wrong_value_of_every_field_is_refused_in_plain_words(kind):
    refused = []
    for *above, last in places(EVERY_FIELD[kind]):
        for wrong in WRONG:
            fields = copy.deepcopy(EVERY_FIELD[kind])
            table = fields
            for key in above:
                table = table[key]
            table[last] = wrong
            try:
                parse(kind, fields, Path("file.toml"))
            except InputError as error:
                refused.append(error)
    assert len(refused) > 100
    assert all(e.field and e.problem and e.remedy for e in refused)
    assert not [str(e) for e in refused if any(word in str(e) for word in JARGON)]


def test_the_fields_of_the_test_are_sound():
    for kind, fields in EVERY_FIELD.items():
        parse(kind, fields, Path("file.toml"))
        optional = {"description", "source", "name"} if kind is Material else set()
        assert set(fields) == set(kind.model_fields) - optional


def test_a_list_of_a_fixed_length_is_asked_for_as_such(refused):
    material = EVERY_FIELD[Material] | {"albedo": [0.1] * 4}
    refused(lambda: parse(Material, material, Path("a.toml")), "albedo", "give a list of 3")


def test_the_nearest_names_are_told_and_no_others():
    assert nearest("no maskng", ["no masking", "tiles"]) == "is it 'no masking'? "
    assert nearest("zzzz", ["no masking"]) == ""
