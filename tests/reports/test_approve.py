"""Budgets from what was measured: tighter by themselves, looser with a reason, comments kept."""

import tomllib

import numpy as np
import pytest

from reports.approve import check, proposals, rewritten, row_limit
from reports.gate import judge
from reports.results import Results, save_results
from scenes.errors import InputError
from scenes.suite import Budget, load_suite
from tests.reports.pages import BUDGET, results, row

RULES = (
    Budget(technique="paper", truth="global", energy_local=0.3, ssim=0.8),
    Budget(technique="paper", truth="global", material="gold", energy_local=0.12, reason="gold"),
)
TEXT = """# Why these stand here.
[[budget]]
technique = "paper"
truth = "global"
energy_local = 0.3 # a third
ssim = 0.8

[[budget]]
technique = "paper"
truth = "global"
material = "gold"
energy_local = 0.12
reason = "gold"
"""


def judged(**fields):
    return judge(row(**fields), RULES)


def test_a_budget_becomes_the_worst_of_its_rows_with_something_to_spare():
    rows = [judged(energy_local=0.1), judged(object="right", energy_local=0.05)]
    found = {p.metric: p for p in proposals(results(rows), RULES, 0.1)}
    assert set(found) == {"energy_local", "ssim"}
    own = found["energy_local"]
    assert (own.old, own.looser, own.row.object) == (0.3, False, "left")
    assert own.new == pytest.approx(0.1 * 1.1, rel=0.3) and own.new > 0.1 * 1.1
    assert found["ssim"].new < 0.95 and not found["ssim"].looser


def test_a_row_counts_for_the_rule_that_holds_for_it():
    rows = [judged(energy_local=0.05), judged(material="gold", energy_local=0.2)]
    found = {(p.rule, p.metric): p for p in proposals(results(rows), RULES, 0.0)}
    assert 0.05 < found[0, "energy_local"].new < 0.1
    assert found[1, "energy_local"].looser and found[1, "energy_local"].new > 0.2
    assert (1, "ssim") not in found  # the first rule's holds for gold too


@pytest.mark.parametrize("spare", [0.0, 0.1, 1.0])
@pytest.mark.parametrize("figures", [{}, {"energy_local": 0.123, "ssim": 0.9876}])
def test_what_was_measured_passes_the_budget_it_gives(figures, spare):
    measured = judged(**figures)
    limits = {m: row_limit(measured, m, spare) for m in ("energy_local", "ssim")}
    again = judge(measured, [Budget(technique="paper", truth="global", **limits)])
    assert again.verdict == "pass"


def test_the_file_keeps_its_comments_and_takes_the_new_limits():
    rows = [judged(energy_local=0.1), judged(material="gold", energy_local=0.2)]
    chosen = proposals(results(rows), RULES, 0.1)
    text = rewritten(TEXT, chosen, "a new bunny")
    assert "# Why these stand here." in text and "# a third" in text
    rules = tomllib.loads(text)["budget"]
    assert rules[0]["energy_local"] < 0.3 and "reason" not in rules[0]
    assert rules[1]["energy_local"] > 0.2 and rules[1]["reason"] == "gold; a new bunny"
    assert rewritten(text, chosen, "a new bunny") == text


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"skipped": ["spheres.noon (filter 'dusk')"]}, "only a part of its suite"),
        ({"rows": [row(problem="is blank")]}, "is blank"),
        ({"rows": [judge(row(), [])]}, "no row has a budget"),
        ({"rows": [judged(ssim_se=np.nan)]}, "ssim of left in spheres.dusk is infinite or has no"),
        (
            {"rows": [judged(energy_local=np.inf)]},
            "energy_local of left in spheres.dusk is inf",
        ),
        ({"budgets": []}, "are not those of the suite any more"),
    ],
)
def test_results_that_tell_too_little_are_refused(tmp_path, fields, words):
    run = Results(**dict(results([judged()], budgets=list(RULES))) | fields)
    with pytest.raises(InputError, match=words):
        check(run, RULES, tmp_path / "results.json")


@pytest.fixture
def measured(tmp_path):
    """A suite's file and the results of a run of it."""
    head = 'description = "d"\\ntechniques = ["paper"]\\ntruths = ["global"]\\n'
    run = '[[run]]\\nscene = "contact"\\nenvironments = ["studio"]\\n\\n'
    (tmp_path / "own.toml").write_text((head + run).encode().decode("unicode_escape") + TEXT)
    rows = [judged(energy_local=0.1), judged(material="gold", energy_local=0.2)]
    found = results(rows, suite_path=str(tmp_path / "own.toml"), budgets=list(RULES))
    save_results(found, tmp_path / "results.json")
    return tmp_path


def test_the_command_shows_the_difference_and_writes_when_told(shadeproof, measured):
    suite, before = measured / "own.toml", (measured / "own.toml").read_text()
    code, out, err = shadeproof("approve", measured / "results.json")
    assert code == 0, err
    assert "-energy_local = 0.3 # a third" in out and "looser, so it takes a --reason" in out
    assert suite.read_text() == before
    shadeproof("approve", measured / "results.json", "--reason", "  ", "--write")
    tight = load_suite(str(suite))[0].budget
    assert tight[0].energy_local < 0.3 and tight[1].energy_local == 0.12
    code, _, err = shadeproof("approve", measured / "results.json")
    assert code == 2 and "are not those of the suite any more" in err
    suite.write_text(before)
    shadeproof("approve", measured / "results.json", "--reason", "old", "--write")
    assert load_suite(str(suite))[0].budget[1].reason == "gold; old"  # not a part of a word


def test_a_silhouette_leaves_room_for_another_rasteriser():
    measured = judge(row(silhouette=1.0), [BUDGET.model_copy(update={"silhouette": 0.9})])
    assert row_limit(measured, "silhouette", 0.1) == pytest.approx(0.995)


def test_a_suite_that_is_gone_is_told(shadeproof, measured):
    (measured / "own.toml").unlink()
    code, _, err = shadeproof("approve", measured / "results.json")
    assert code == 2 and "names a suite that is gone" in err
