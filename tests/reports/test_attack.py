"""The gate under attack: what is injected, and that the real gate sees it."""

import json
from collections import Counter

import pytest

from reports.attack.harness import run
from reports.attack.mutants import RENDERER, Change, arguments, by_rule, select, written
from reports.attack.results import Attack, load_attack, save_attack
from reports.attack.rules import changes, chosen, patches
from reports.run.attack import attack_suite, shipped
from scenes.errors import InputError


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    return shipped("guard", tmp_path_factory.mktemp("store"))


@pytest.mark.parametrize(
    ("line", "rule", "after"),
    [
        ("    return a * b;", "operator", "    return a / b;"),
        ("    return a * b;", "dropped factor", "    return a;"),
        ("    x += f(a).xy;", "operator", "    x -= f(a).xy;"),
        ("    return a + b * c;", "dropped term", "    return a;"),
        ("    return a - (b + c) / d;", "dropped term", "    return a;"),
        ("    float x = 0.5 * h.z;", "constant", "    float x = 0.55 * h.z;"),
        ("    float x = 0.0;", "constant", "    float x = 0.1;"),
        ("    uint b = i << 16u;", "constant", None),
        ("    int i = a[3];", "constant", "    int i = a[4];"),
        ("    float x = h.z;", "swizzle", "    float x = h.x;"),
        ("    if (x <= 0.0) return;", "comparison", "    if (x > 0.0) return;"),
        ("    x = max(a, f(b, c));", "extremum", "    x = min(a, f(b, c));"),
        ("    x = max(a, f(b, c));", "dropped call", "    x = (a);"),
        ("    x = G(wi, wo, h);", "swapped arguments", "    x = G(wo, wi, h);"),
        ("    x = a * b; // a * b", "operator", "    x = a / b; // a * b"),
    ],
)
def test_a_rule_changes_one_thing_of_a_line(line, rule, after):
    made = [changed for by, changed in changes(line) if by == rule]
    assert (after in made) if after else not made


@pytest.mark.parametrize(
    "line",
    ["// a * b", "uniform vec3 a; // b * c", '#include "a.glsl"', "}", "vec3 f(int a, int b) {"],
)
def test_comments_and_declarations_are_left_alone(line):
    assert not list(changes(line))


def test_every_mutant_by_rule_differs_from_its_line_and_from_the_others():
    every = patches(RENDERER)
    assert len(every) > 800
    assert all(p.before != p.after for p in every)
    assert len({(p.file, p.line, p.after) for p in every}) == len(every)
    assert len({i.id for i in by_rule(every)}) == len(every)


def test_a_choice_has_every_file_and_every_rule_and_is_the_same_every_time():
    every = patches(RENDERER)
    drawn = chosen(every, 150, 5)
    assert len(drawn) == 150
    assert drawn == chosen(every, 150, 5) != chosen(every, 150, 6)
    assert {p.file for p in drawn} == {p.file for p in every}
    assert {p.rule for p in drawn} == {p.rule for p in every}


def test_bugs_and_controls_fit_the_sources():
    """If it fails, a shader has changed: mend the text in bugs.toml or controls.toml."""
    bugs, controls = written("realistic"), written("control")
    assert len(bugs) >= 40 and len(controls) >= 20
    assert all(i.before != i.after for i in bugs + controls)
    assert max(Counter(i.id for i in bugs + controls).values()) == 1


def test_every_argued_change_can_still_be_made():
    """If it fails, a shader has changed: is the argument in equivalent.toml still right?"""
    can = {(p.file, p.before.strip(), p.after.strip()) for p in patches(RENDERER)}
    can |= {(i.file, i.before.strip(), i.after.strip()) for i in written("realistic")}
    for entry in arguments():
        assert (entry["file"], entry["before"].strip(), entry["after"].strip()) in can, entry
        assert len(entry["why"]) > 20


def test_a_change_is_made_where_it_was_found(tmp_path):
    (tmp_path / "a.glsl").write_text("x = a;\ny = b;\nx = a;\n")
    Change("i", "rule", "r", "a.glsl", 3, "x = a;", "x = c;").apply(tmp_path)
    assert (tmp_path / "a.glsl").read_text() == "x = a;\ny = b;\nx = c;\n"


def named(name: str) -> Change:
    (found,) = (i for i in select(0, 0)[0] if i.id == name)
    return found


@pytest.mark.parametrize(
    ("name", "outcome", "by"),
    [
        ("weights of D used for G", "caught", "rows"),
        ("Beckmann served by GGX without the ratio", "caught", "prefiltered"),
        ("another frame around n", "passed", ""),
    ],
)
def test_the_real_gate_sees_bugs_and_passes_rewrites(name, outcome, by, store):
    mutant = run(named(name), "guard", store)
    assert (mutant.outcome, mutant.exit_code) == (outcome, int(outcome == "caught"))
    assert by in mutant.by


def test_a_change_that_does_not_compile_counts_apart(store):
    broken = Change("x", "rule", "", "shaders/brdf.glsl", 1, "vec3 f = F", "vec3 f = nothing")
    mutant = run(broken, "guard", store)
    assert (mutant.outcome, mutant.exit_code) == ("stillborn", 2)
    assert "nothing" in mutant.by


def test_an_attack_is_refused_where_the_gate_fails_by_itself(store, monkeypatch):
    bug = named("no masking")
    monkeypatch.setattr("reports.attack.harness.Change", lambda *_: bug)
    with pytest.raises(InputError, match="the gate fails where nothing is changed"):
        attack_suite("guard", store, [bug], 1, print, command="", seed=0, generated=0)


def test_an_attack_passes_only_if_all_is_caught_or_argued_and_nothing_alarms(tmp_path):
    def attack(*outcomes, argued=""):
        mutants = [
            {
                "id": str(n),
                "kind": "control" if o in ("passed", "alarm") else "rule",
                "file": "a",
                "line": 1,
                "before": "",
                "after": "",
                "outcome": o,
                "exit_code": 0,
                "seconds": 1.0,
                "equivalent": argued,
            }
            for n, o in enumerate(outcomes)
        ]
        about = {"created": "", "seconds": 1.0, "command": "", "suite": "", "seed": 1}
        return Attack(**about, generated=9, provenance={}, mutants=mutants)

    assert attack("caught", "stillborn", "passed").passed
    assert not attack("caught", "survived").passed
    assert attack("survived", argued="nobody sees it").passed
    assert not attack("passed", "alarm").passed
    made = attack("caught")
    save_attack(made, tmp_path / "attack.json")
    assert load_attack(tmp_path / "attack.json") == made


def test_a_suite_without_references_is_told_in_one_line(shadeproof, tmp_path):
    code, _, err = shadeproof("attack", "--suite", "full", "--out", tmp_path)
    assert code == 2 and "comes without references" in err


def test_the_schema_in_the_docs_is_the_schema(request):
    documented = json.loads((request.config.rootpath / "docs/attack.schema.json").read_text())
    assert documented == Attack.model_json_schema()


@pytest.mark.long
def test_the_gate_withstands_the_whole_attack(shadeproof, tmp_path):
    code, said, err = shadeproof("attack", "--out", tmp_path)
    assert code == 0, said + err
