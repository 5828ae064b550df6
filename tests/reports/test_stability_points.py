"""The worst points of the maps can be evaluated again by their commands, and slips are told."""

import json
import shlex

import numpy as np
import pytest
from typer.testing import CliRunner

from reports.cli.main import app
from reports.run.stability import at, furnaces, geometry, hard_cases, hard_names, lookups, terms
from reports.run.stability.at import evaluate, step
from reports.run.stability.brdf import Sweep
from reports.run.stability.sides import shader
from reports.stability.answers import Answer
from reports.stability.functions import FUNCTIONS
from reports.stability.points import INTEGRALS, Point, point
from reports.stability.promise import HARD_HOLDS, promises
from reports.stability.results import Promise, Stability
from reports.stability.table import promised

BRDF = "brdf alpha=.01 weight=.5 masking=smith wi=0,.6,.8 wo=.6,0,.8"


def points_of(command: str) -> list[Point]:
    """What a map's command evaluates."""
    words = shlex.split(command)
    assert words[:2] == ["shadeproof", "stability"] and set(words[2::2]) == {"--at"}
    return [point(text) for text in words[3::2]]


def again(command: str) -> Answer:
    """The answer to the one point of a map's command."""
    (one,) = points_of(command)
    return evaluate(one)


@pytest.fixture(scope="module")
def sweep():
    return {m.invariant: m for m in Sweep("smith").maps()}


def test_the_worst_of_a_term_comes_back_by_its_command_with_its_figure():
    for name in ("D_beckmann", "beckmann_over_ggx"):
        m = next(m for m in terms.ndfs() if m.function == name)
        (figure,) = again(m.worst.command).figures
        assert figure.value == pytest.approx(m.worst.value, rel=1e-3) and figure.passed == m.passed
    m = next(m for m in terms.samplers() if m.function == "sample_ggx")
    (figure,) = again(m.worst.command).figures
    assert figure.value == pytest.approx(m.worst.value, rel=1e-3)


@pytest.mark.parametrize(("invariant", "which"), [("against float64", 0), ("against Mitsuba", 1)])
def test_the_worst_of_the_brdf_comes_back_with_its_figure(sweep, invariant, which):
    m = sweep[invariant]
    answer = again(m.worst.command)
    assert answer.figures[which].value == pytest.approx(m.worst.value, rel=1e-3)
    assert answer.passed and {"GLSL", "float64", "Mitsuba"} <= dict(answer.sides).keys()


@pytest.mark.parametrize("invariant", ["smooth in weight", "smooth in roughness", "reciprocal"])
def test_two_points_tell_a_step_as_its_map_does(sweep, invariant):
    m = sweep[invariant]
    answer = step(*points_of(m.worst.command))
    (figure,) = answer.figures
    assert figure.value == pytest.approx(m.worst.value, rel=0.02) and figure.limit == m.limit


def test_two_points_of_different_kinds_have_no_step_to_judge():
    first, other = point(BRDF), point(BRDF.replace("alpha=.01 weight=.5", "alpha=.02 weight=.6"))
    assert not step(first, other).figures
    assert step(first, point("D_ggx h=0,0,1 alpha=.1")) is None


def test_a_furnace_comes_back_by_its_command():
    found = list(furnaces.maps(np.array([0.1, 1.0]), np.array([0.1, 1.0])))
    for m in found:
        (figure,) = again(m.worst.command).figures
        assert figure.value == pytest.approx(m.worst.value, rel=1e-6)
        assert figure.limit == m.limit and figure.passed


def test_what_surrounds_the_brdf_comes_back_by_its_commands():
    found = [lookups.radiance_lod(), geometry.tangent_frame(), geometry.latlong()]
    for m in (*found, terms.hammersley()):
        (figure,) = again(m.worst.command).figures
        assert figure.passed and figure.limit == m.limit
    (figure,) = again(found[0].worst.command).figures
    assert figure.value == pytest.approx(found[0].worst.value)
    texel = evaluate(point("scale_bias n.v=0.9 roughness=.5 weight=.5 masking=smith"))
    assert texel.figures[0].value < 0.005 and texel.figures[0].limit is None


MIRROR = "brdf alpha=.01 weight=.5 wi=0,.6,.8 wo=0,-.6,.8"
BROKEN = [
    ("brdf", lambda found: found * np.float32(1.001), MIRROR, False),
    ("brdf", lambda found: found * np.nan, MIRROR, False),
    ("brdf", lambda found: found * np.nan, MIRROR.replace(".01", ".001"), False),
    ("brdf", lambda found: found * np.float32(1.001), MIRROR.replace(".01", ".001"), True),
    ("hammersley", lambda found: found + 1, "hammersley index=1 points=4", False),
]


@pytest.mark.parametrize(("name", "change", "text", "passed"), BROKEN)
def test_a_figure_over_its_limit_ends_with_1(monkeypatch, name, change, text, passed):
    """Outside of what is promised only what is no number fails."""
    monkeypatch.setattr(at, "shader", lambda *given: change(shader(*given)))
    result = CliRunner().invoke(app, ["stability", "--at", text])
    assert result.exit_code == (0 if passed else 1)
    assert ("no limit here" if ".001" in text else "allowed") in result.output


def test_nothing_over_nothing_is_no_error():
    answer = evaluate(point("F_schlick f0=0,0,0 cosine=1"))
    assert answer.passed and answer.figures[0].value == 0


@pytest.mark.parametrize("name", [*FUNCTIONS, *INTEGRALS])
def test_every_function_says_what_it_lacks_or_works_without(name):
    result = CliRunner().invoke(app, ["stability", "--at", name])
    assert result.exit_code == 1 and type(result.exception).__name__ == "InputError"
    assert "lacks its input" in str(result.exception)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ("no function",)),
        ("brd wi=0,0,1", ("no function 'brd'", "is it 'brdf'", "--list")),
        ("D_ggx h=0,0,1 alpha=x", ("'x' is no number", "give a number")),
        ("D_ggx h=0,0,1 alpha=nan", ("is no number",)),
        ("D_ggx h=0,0,1 alpha=0", ("outside of (0, 1]",)),
        ("D_ggx h=0,0,1 alpha=2", ("outside of (0, 1]",)),
        ("D_ggx h=0,1 alpha=.1", ("has 2 numbers", "give 3")),
        ("D_ggx h=0,0,1 beta=.1", ("has no input 'beta'", "alpha=...")),
        ("D_ggx h=0,0,1 .1", ("has no input '.1'",)),
        ("brdf wi=0,0,1 wo=0,0,1 alpha=.1 masking=none", ("no masking", "paper or smith")),
        ("hammersley index=.5 points=3", ("counts nothing",)),
        ("D_ggx h=0,0,1 alpha=.1 alpha=.2", ("has alpha twice", "give it once")),
        ("D_ggx h=0,0,1.01 alpha=.1", ("is 1.01 long", "length 1")),
        ("D_ggx h=0,0,0 alpha=.1", ("is 0 long",)),
        ("D_mixture h=0,0,1 alpha=.1 weight=1.5", ("outside of [0, 1]",)),
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
    told = str(refused.exception)
    assert "no hard case 'oposite'; is it 'opposite' or" in told and len(told) < 120


def test_functions_and_hard_cases_are_listed():
    listed = CliRunner().invoke(app, ["stability", "--list"]).output.splitlines()
    assert "--hard opposite" in listed and "--at 'D_ggx h=... alpha=...'" in listed
    assert len(listed) == len(FUNCTIONS) + len(INTEGRALS) + len(hard_names())


def test_a_folder_that_cannot_be_written_is_told_before_anything_is_measured(tmp_path, monkeypatch):
    monkeypatch.setattr("reports.run.stability.stability", lambda *_: pytest.fail("measured"))
    (tmp_path / "file").touch()
    result = CliRunner().invoke(app, ["stability", "--out", str(tmp_path / "file/out")])
    assert "cannot be written" in str(result.exception)


@pytest.mark.parametrize(
    ("claim", "worst", "told"),
    [
        ("At most what comes", 1.000024, "worst 1 + 2.4e-05"),
        ("At most what comes", 0.9999, "worst 1 - 0.0001"),
        ("Agrees", 3e-5, "worst 3e-05"),
        (HARD_HOLDS, 0.0, "116 of 116"),
        (HARD_HOLDS, 2.0, "114 of 116"),
    ],
)
def test_a_promise_is_told_by_what_counts(claim, worst, told):
    assert promised(Promise(claim=claim, bounds={}, worst=worst, held=True), 116) == told


def test_a_direction_that_is_rounded_is_made_a_unit_vector():
    h = point("D_ggx h=.6,0,.8003 alpha=.1").inputs["h"]
    assert np.hypot(*h[[0, 2]]) == pytest.approx(1, abs=1e-7)
    exact = point("D_ggx h=0.600000024,0,0.800000012 alpha=.1").inputs["h"]
    assert exact.tolist() == np.float32([0.6, 0, 0.8]).tolist()


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
