"""The worst points of the maps can be evaluated again by their commands, and slips are told."""

import json
import shlex

import numpy as np
import pytest
from typer.testing import CliRunner

from reports.cli.main import app
from reports.run.stability import furnaces, geometry, hard_cases, terms
from reports.run.stability.at import evaluate
from reports.run.stability.brdf import Sweep
from reports.stability.functions import FUNCTIONS
from reports.stability.points import INTEGRALS, point
from reports.stability.promise import promises
from reports.stability.results import Stability

BRDF = "brdf alpha=.01 weight=.5 masking=smith wi=0,.6,.8 wo=.6,0,.8"


def again(command: str) -> list[dict[str, np.ndarray]]:
    """What a map's command evaluates."""
    words = shlex.split(command)
    assert words[:2] == ["shadeproof", "stability"] and set(words[2::2]) == {"--at"}
    return [dict(evaluate(point(text))) for text in words[3::2]]


def test_a_worst_difference_comes_back_by_its_command():
    m = next(m for m in terms.ndfs() if m.function == "D_beckmann")
    (told,) = again(m.worst.command)
    relative = told["difference"] / np.maximum(told["float64"], 1e-300)
    assert relative.max() == pytest.approx(m.worst.value, rel=1e-3)


def test_the_worst_of_the_brdf_comes_back_with_mitsubas_answer():
    first = next(Sweep("smith").maps())
    (told,) = again(first.worst.command)
    assert np.abs(told["Mitsuba"] / told["float64"] - 1).max() < 1e-4
    worst = (told["difference"] / told["float64"]).max()
    assert worst >= first.worst.value * 0.99  # the map's is over the peak, where f is small


def test_two_points_tell_a_step():
    m = next(m for m in Sweep("paper").maps() if m.invariant == "smooth in weight")
    before, after = again(m.worst.command)
    assert not np.array_equal(before["GLSL"], after["GLSL"])


def test_a_furnace_comes_back_by_its_command():
    found = list(furnaces.maps(np.array([0.1, 1.0]), np.array([0.1, 1.0])))
    for m in found:
        (told,) = again(m.worst.command)
        assert told["GLSL"].item() == pytest.approx(m.worst.value, rel=1e-6)


def test_a_level_and_a_texel_come_back_by_their_commands():
    level = geometry.radiance_lod()
    (told,) = again(level.worst.command)
    assert np.abs(told["GLSL"] - told["float64"]).item() == pytest.approx(level.worst.value)
    (texel,) = again(
        "shadeproof stability --at 'scale_bias n.v=0.9 roughness=.5 weight=.5 masking=smith'"
    )
    assert np.abs(texel["GLSL"] - texel["float64"]).max() < 0.005


@pytest.mark.parametrize("name", [*FUNCTIONS, *INTEGRALS])
def test_every_function_says_what_it_lacks_or_works_without(name):
    result = CliRunner().invoke(app, ["stability", "--at", name])
    assert result.exit_code == 1 and type(result.exception).__name__ == "InputError"
    assert "lacks its input" in str(result.exception)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ("no function",)),
        ("brd wi=0,0,1", ("no function 'brd'", "brdf")),
        ("D_ggx h=0,0,1 alpha=x", ("'x' is no number", "give a number")),
        ("D_ggx h=0,0,1 alpha=nan", ("is no number",)),
        ("D_ggx h=0,0,1 alpha=0", ("outside of (0, 1]",)),
        ("D_ggx h=0,0,1 alpha=2", ("outside of (0, 1]",)),
        ("D_ggx h=0,1 alpha=.1", ("has 2 numbers", "give 3")),
        ("D_ggx h=0,0,1 beta=.1", ("has no input 'beta'", "alpha=...")),
        ("D_ggx h=0,0,1 .1", ("has no input '.1'",)),
        ("brdf wi=0,0,1 wo=0,0,1 alpha=.1 masking=none", ("no masking", "paper or smith")),
        ("hammersley index=.5 points=3", ("counts nothing",)),
        ("radiance_lod size=0,1 w=0,0,1 density=1", ("is no size",)),
    ],
)
def test_a_slip_in_a_point_is_told(refused, text, words):
    refused(lambda: point(text), "--at", *words)


def test_a_weight_is_a_share_or_a_pair():
    assert point(BRDF).inputs["weight"].tolist() == [0.5, 0.5]
    pair = point(BRDF.replace("weight=.5", "weight=1,0.25")).inputs
    assert pair["weight"].tolist() == pair["weight_g"].tolist() == [1, 0.25]


def test_the_command_prints_every_side_of_a_point():
    result = CliRunner().invoke(app, ["stability", "--at", BRDF])
    assert result.exit_code == 0
    for words in ("GLSL", "float64", "Mitsuba", "difference"):
        assert words in result.output


def test_the_command_tries_one_hard_case():
    result = CliRunner().invoke(app, ["stability", "--hard", "opposite"])
    assert result.exit_code == 0 and "opposite" in result.output
    refused = CliRunner().invoke(app, ["stability", "--hard", "oposite"])
    assert "no hard case 'oposite'" in str(refused.exception)


def test_a_point_and_a_hard_case_are_not_asked_for_at_once():
    result = CliRunner().invoke(app, ["stability", "--hard", "opposite", "--at", BRDF])
    assert "give one of the two" in str(result.exception)


def test_a_promise_that_is_broken_is_told(monkeypatch):
    maps = [*terms.ndfs(), *furnaces.maps(np.array([0.1]), np.array([0.5]))]
    cases = hard_cases(["opposite"])
    assert all(p.held for p in promises(maps, cases))
    maps[0] = maps[0].model_copy(update={"worst": maps[0].worst.model_copy(update={"value": 2e-4})})
    cases[0] = cases[0].model_copy(update={"passed": False})
    broken = [p.claim for p in promises(maps, cases) if not p.held]
    assert len(broken) == 3


def test_the_schema_in_the_docs_is_the_schema(request):
    path = request.config.rootpath / "docs/stability.schema.json"
    assert json.loads(path.read_text(encoding="utf-8")) == Stability.model_json_schema()
