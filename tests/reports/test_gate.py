"""Verdicts: what passes, what fails, and what must never pass unseen."""

import io
import math
from xml.etree import ElementTree

import pytest
from rich.console import Console
from typer.testing import CliRunner

from reports import ci, gate
from reports.cli import judging, options
from reports.cli.app import app
from reports.results import Missing, Results, Row
from reports.terminal import describe, print_results
from scenes.suite import Budget, expand, load_suite

PASSING = {
    "ssim": 0.95,
    "ssim_se": 0.002,
    "ssim_dof": 400,
    "energy_error": 0.01,
    "energy_se": 0.001,
    "energy_dof": 1000,
    "energy_local": 0.03,
    "energy_local_se": 1e-4,
    "energy_local_dof": 60,
    "reference_spp": 256,
}
RULES = [Budget(technique="paper", truth="global", energy_error=0.05, energy_local=0.1, ssim=0.9)]


def as_asked(entry, technique, truth):
    """The model of a technique that draws no other than the case's."""
    return entry.case.model


def row(**changes):
    fields = {
        "case": "bunnies.courtyard",
        "scene": "bunnies",
        "environment": "courtyard",
        "object": "silver",
        "material": "silver",
        "roughness": 0.1,
        "metallic": 1.0,
        "weight": 1.0,
        "weight_g": 1.0,
        "technique": "paper",
        "picture": "paper",
        "truth": "global",
    }
    return Row(**(fields | PASSING | changes))


def results(rows, **changes):
    fields = {
        "suite": "s",
        "suite_path": "s.toml",
        "description": "",
        "command": "shadeproof gate",
        "created": "",
        "seconds": 1.0,
        "provenance": {},
        "allow_inconclusive": False,
        "expected_rows": len(rows),
        "missing": [],
        "skipped": [],
        "cases": [],
        "budgets": RULES,
        "rows": rows,
        "verdict": "fail",
        "reasons": [],
    }
    return gate.conclude(Results(**(fields | changes)))


@pytest.mark.parametrize(
    ("changes", "verdict"),
    [
        ({}, "pass"),
        ({"energy_error": 0.08}, "fail"),
        ({"energy_error": -0.08}, "fail"),
        ({"energy_error": 0.05}, "inconclusive"),
        ({"energy_error": -0.05}, "inconclusive"),
        ({"energy_local": 0.2}, "fail"),
        ({"ssim": 0.85}, "fail"),
        ({"ssim": 0.9}, "inconclusive"),
        ({"ssim": math.nan}, "fail"),
        ({"ssim_se": math.nan, "ssim_dof": 0}, "inconclusive"),
        ({"energy_se": math.nan, "energy_dof": 0}, "inconclusive"),
        ({"problem": "is blank where the truth is not"}, "fail"),
        ({"truth": "unoccluded"}, "reported"),
    ],
)
def test_a_row_is_judged_by_its_whole_interval(changes, verdict):
    assert gate.judge(row(**changes), RULES).verdict == verdict


def test_an_override_changes_only_the_rows_it_names():
    rules = [
        *RULES,
        Budget(technique="paper", truth="global", material="silver", ssim=0.5, reason="because"),
    ]
    low = {"ssim": 0.6}
    judged = gate.judge(row(**low), rules)
    assert judged.verdict == "pass"
    assert judged.budget["energy_local"] == 0.1
    assert "because" in judged.note
    assert gate.judge(row(material="copper", **low), rules).verdict == "fail"


def test_inconclusive_says_how_many_samples_would_decide():
    judged = gate.judge(row(energy_error=0.045, energy_se=0.006), RULES)
    # 3.3 standard errors of .006 for 1e-3, at a distance of .005, squared: 15.7 times the 256.
    assert "about 4016 samples" in judged.note


def test_a_row_that_fails_asks_for_no_samples_for_its_other_figures():
    failing = gate.judge(row(ssim=0.5, energy_error=0.045, energy_se=0.006), RULES)
    assert failing.verdict == "fail" and failing.undecided == ["energy_error"]
    assert "would decide" not in failing.note
    broken = gate.judge(row(problem="crashed", energy_error=0.045, energy_se=0.006), RULES)
    assert "would decide" not in broken.note


def test_the_samples_that_would_decide_are_more_than_were_taken():
    # Its square, .0009 ± .0095, reaches up to .102²: over the budget, and far from the figure.
    skew = gate.judge(row(energy_local=0.03, energy_local_se=0.00275), RULES)
    assert skew.undecided == ["energy_local"]
    told = "energy_local: its noise is uneven: at least twice the samples would decide"
    assert told in skew.note and "about" not in skew.note


def test_a_figure_that_noise_hides_is_undecided_and_not_missed():
    hidden = gate.judge(row(energy_error=0.052, energy_se=0.006), RULES)
    assert hidden.verdict == "inconclusive"
    assert "energy_error 5.2% of 5% undecided" in describe(hidden)
    assert "MISSED" not in describe(hidden)
    assert "energy_error 8% of 5% MISSED" in describe(gate.judge(row(energy_error=0.08), RULES))


def test_verdicts_of_a_family_hold_together_at_one_in_a_thousand():
    near = row(energy_error=0.046)  # 4 standard errors within its budget
    assert gate.judge(near, RULES, family=1).verdict == "pass"
    assert gate.judge(near, RULES, family=800).verdict == "inconclusive"
    assert gate.judge(near, RULES, family=800).undecided == ["energy_error"]
    levels = [gate.judge(near, RULES, family=m).confidence for m in (1, 800)]
    assert [level**m for level, m in zip(levels, (1, 800), strict=True)] == pytest.approx(
        [0.999] * 2
    )


def test_the_family_counts_every_budgeted_figure_at_every_look():
    suite, path = load_suite("tiny")
    entries = expand(suite, path)
    judged = len(entries[0].case.judged)

    def own(entry):
        return entry.techniques

    # Two techniques with energy_error, energy_local and ssim. 128 samples in batches of 16.
    assert gate.family_size(suite.budget, entries, suite.reference, as_asked, own) == 6 * judged
    longer = suite.reference.model_copy(update={"max_samples": 512})
    assert gate.family_size(suite.budget, entries, longer, as_asked, own) == 18 * judged


def test_the_interval_of_local_energy_is_the_root_of_its_squares():
    low, high = gate.bounds(row(energy_local=0.03, energy_local_se=5e-4), "energy_local", 0.95)
    assert low == pytest.approx(0, abs=1e-9)
    assert high == pytest.approx(math.sqrt(9e-4 + 2.0 * 5e-4), rel=1e-3)


@pytest.mark.parametrize(
    ("changes", "unsharp"),
    [
        ({}, []),
        ({"energy_error": 0.0, "energy_se": 0.01}, ["energy_error"]),
        ({"ssim": 1.0, "ssim_se": 0.02}, ["ssim"]),
        ({"energy_error": 0.5, "energy_se": 0.01}, ["energy_error"]),
        ({"energy_error": 0.5, "energy_se": 0.01, "problem": "crashed"}, []),
        ({"energy_local": math.inf}, []),
    ],
)
def test_an_interval_wider_than_a_third_of_its_budget_asks_for_more(changes, unsharp):
    judged = gate.judge(row(**changes), RULES)
    assert judged.unsharp == unsharp
    assert gate.settled(judged) == (not unsharp and not judged.undecided)


@pytest.mark.parametrize(
    ("rows", "changes", "reason"),
    [
        ([], {}, "no case"),
        (
            [row()],
            {"missing": [Missing(case="c", object="o", technique="t", truth="global")]},
            "missing",
        ),
        ([row(problem="took longer than 5 s")], {}, "fail"),
        ([row(energy_error=0.05)], {}, "inconclusive"),
        ([row(truth="unoccluded")], {}, "nothing was judged"),
    ],
)
def test_a_run_fails_with_its_reason(rows, changes, reason):
    judged = [gate.judge(r, RULES) for r in rows]
    concluded = results(judged, **changes)
    assert concluded.verdict == "fail"
    assert any(reason in r for r in concluded.reasons)


def test_a_run_without_budgets_is_reported_and_fails_a_gate():
    unjudged = gate.judge(row(), [])
    run = results([unjudged], budgets=[])
    assert gate.headline(run) == "reported" and run.verdict == "fail"
    said = io.StringIO()
    print_results(run, Console(file=said, width=120))
    assert "REPORTED: 0 pass" in said.getvalue() and "FAIL" not in said.getvalue()
    assert "no row has a budget" in said.getvalue()


def told_in_terminal(rows):
    said = io.StringIO()
    print_results(results([gate.judge(r, RULES) for r in rows]), Console(file=said, width=120))
    return [line.split() for line in said.getvalue().splitlines()]


def test_objects_of_a_weight_each_are_a_list_in_the_terminal():
    rows = [row(material=m, object=m, weight=w) for m, w in (("silver", 0.2), ("gold", 0.7))]
    told = told_in_terminal(rows)
    assert ["material", "weight", "figures"] in told
    assert [line[3] for line in told if line[:1] in (["silver,"], ["gold,"])] == ["0.2", "0.7"]
    crossed = told_in_terminal([row(weight=w) for w in (0.2, 0.7)])
    assert ["material", "weight", "0.7", "weight", "0.2"] in crossed


def test_what_went_wrong_is_a_failure_without_budgets_too():
    gap = Missing(case="c", object="o", technique="t", truth="global")
    unjudged = gate.judge(row(), [])
    assert gate.headline(results([unjudged], missing=[gap])) == "fail"
    assert gate.headline(results([unjudged, gate.judge(row(problem="crashed"), [])])) == "fail"
    assert gate.headline(results([])) == "fail"
    assert gate.headline(results([gate.judge(row(), RULES), unjudged])) == "pass"


def test_a_good_run_passes():
    assert results([gate.judge(row(), RULES)]).verdict == "pass"


def test_inconclusive_passes_where_the_suite_allows_it():
    rows = [gate.judge(row(energy_error=0.05), RULES)]
    assert results(rows, allow_inconclusive=True).verdict == "pass"


def test_missing_rows_are_those_the_run_did_not_give():
    wanted = Missing(case="bunnies.courtyard", object="silver", technique="paper", truth="global")
    other = wanted.model_copy(update={"object": "copper"})
    assert gate.missing_rows([wanted, other], [row()]) == [other]


def test_the_worst_row_is_the_one_furthest_over_its_budget():
    bad = gate.judge(row(object="bad", ssim=0.85), RULES)
    worse = gate.judge(row(object="worse", energy_local=0.4), RULES)
    broken = gate.judge(row(object="broken", problem="crashed"), RULES)
    order = [r.object for r in gate.worst_first([gate.judge(row(), RULES), bad, worse, broken])]
    assert order == ["broken", "worse", "bad", "silver"]


def test_junit_counts_failures_and_missing_rows(tmp_path):
    failing = gate.judge(row(ssim=0.85), RULES)
    gap = Missing(case="c", object="o", technique="t", truth="global")
    run = results([gate.judge(row(), RULES), failing], missing=[gap])
    ci.write_junit(run, tmp_path / "junit.xml")
    root = ElementTree.parse(tmp_path / "junit.xml").getroot()
    assert (root.get("failures"), root.get("errors"), root.get("tests")) == ("2", "1", "4")


def test_the_summary_goes_where_github_says_and_errors_are_annotated(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(tmp_path / "step.md"))
    monkeypatch.setenv("GITHUB_ACTIONS", "true")
    ci.annotate(results([gate.judge(row(problem="50% gone\nnow"), RULES)]), tmp_path / "summary.md")
    assert "FAIL" in (tmp_path / "step.md").read_text()
    assert "::error title=shadeproof bunnies.courtyard::" in (said := capsys.readouterr().err)
    assert "50%25 gone%0Anow" in said


def test_a_gate_without_budgets_says_that_it_fails(monkeypatch):
    said = io.StringIO()
    monkeypatch.setattr(judging, "console", Console(file=said))
    monkeypatch.setattr(options, "make_job", lambda **_: None)
    run = results([gate.judge(row(), [])], budgets=[])
    monkeypatch.setattr(judging, "_compare", lambda *_, **__: run)
    assert CliRunner().invoke(app, ["gate"]).exit_code == 1
    assert "FAIL: a gate needs a row with a budget" in said.getvalue()
