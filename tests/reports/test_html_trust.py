"""What the report says of itself: conformance, references, noise, budgets, the claim of energy."""

import numpy as np
import pytest

from reports.furnace import MASKINGS, energy_claim
from reports.html.trust import facts
from scenes.suite import Budget
from tests.reports.pages import BUDGET, Page, results, row, shown_text, written


def test_trust_shows_conformance_that_fails(folder):
    text = Page(written(results([row()]), folder)).text["dl"]
    assert "Conformance1 of 2 checks pass; background does not" in text
    assert "FAILS: background, off by 3 %" in text and "llvmpipe" in text


def test_a_weight_has_one_name_and_is_explained(folder):
    words = shown_text(Page(written(results([row()]), folder)))
    assert "weight share of GGX" in words and "share of GGX, the rest is Beckmann" in words
    assert "GGX weight" not in words and "mixture weight" not in words and "Parity" not in words


@pytest.mark.parametrize("ours", [True, False])
def test_trust_shows_references_that_other_code_made(folder, ours):
    mine = {"code": "0a7f5396beef", "mitsuba": "3.6.0", "drjit": "1.0.0", "ours": True}
    other = mine | {"code": "1b7f5396beef", "ours": ours}
    run = results([row()])
    run.provenance["references"] = [mine, other]
    (fact,) = [f for f in facts(run) if f.term == "References"]
    assert fact.doubt == (not ours)
    assert ("made by other code: blessed" in fact.text) == (not ours)
    assert ours or fact.detail[0] == "other: code 1b7f5396beef, Mitsuba 3.6.0, Dr.Jit 1.0.0"
    assert fact.text in Page(written(run, folder)).text["dl"]


def test_the_noisiest_row_is_named_with_its_reason(folder):
    loud = row(object="right", case="spheres.noon", truth="direct", energy_local=65.5,
               energy_local_ci95=(63.9, 67.1))  # fmt: skip
    text = Page(written(results([row(), loud]), folder)).text["dl"].replace("\u202f", " ")
    assert (
        "± 160 % (right in spheres.noon, paper vs direct: 6550 % off, its truth has near-black"
    ) in text
    mild = row(object="right", energy_local=0.3, energy_local_ci95=(0.2, 0.4))
    text = Page(written(results([row(), mild]), folder)).text["dl"].replace("\u202f", " ")
    assert "± 10.0 % (right in spheres.dusk, paper vs global)" in text
    assert "near-black" not in text
    assert "right in" not in Page(written(results([mild]), folder)).text["dl"]


def test_noise_of_a_run_without_figures(folder):
    nan = (np.nan,) * 2
    lost = dict.fromkeys(("ssim", "energy_error", "energy_local"), np.nan)
    lost |= dict.fromkeys(("ssim_ci95", "energy_ci95", "energy_local_ci95"), nan)
    for run in (results([row(problem="exit code 1", **lost)]), results([])):
        text = Page(written(run, folder)).text["dl"]
        assert "no row has figures" in text and "no spread" not in text


def test_budgets_say_no_more_than_they_hold(folder):
    zero = Budget(technique="paper", truth="global", weight=0, ssim=0.8, reason="pure Beckmann")
    text = Page(written(results([row()], budgets=[BUDGET, zero]), folder)).text["li"]
    assert "technique paper, truth global, energy_local 0.2, ssim 0.9" in text
    assert "technique paper, truth global, weight 0.0, reason pure Beckmann, ssim 0.8" in text
    assert text.count("reason ") == 1


def test_the_energy_claim_tells_what_kd_at_the_view_angle_keeps_and_loses(folder):
    text = " ".join(Page(written(results([row()]), folder)).text["section"].split())
    assert "sends back at most 100.3 % (100.4 % with smith)" in text
    assert "as little as 12.3 % (roughness 1, 89° from the normal" in text
    assert "loses 87.7 % of the light of a white surface" in text
    claim = energy_claim()
    paper, smith = (claim.least("shortcut", masking) for masking in MASKINGS)
    assert paper.figure == pytest.approx(smith.figure)  # 'with either masking'
    assert "no facets are lost or counted twice" in text and "nothing is made" not in text
