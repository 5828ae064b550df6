"""Limits of detection through the real gate, on batches whose noise is known."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import norm

from renderer.draw import Renderer
from renderer.techniques import technique
from reports.compare import Truth, exposures_of
from reports.limits.detection import draws
from reports.limits.known_errors import known_errors
from reports.noise import sidak
from reports.rows import Picture, judged_rows
from reports.run.job import Job
from reports.run.limits.alarms import false_alarms
from reports.run.limits.judging import Gate, Pool
from reports.run.limits.seen import Seen
from tests.reports.small import small_suite

POOL, NOISE = 32, 0.1  # batches, and the relative noise of a pixel in each
GAIN = next(e for e in known_errors(None) if e.parameter == "gain")


@pytest.fixture(scope="module")
def gate(tmp_path_factory):
    """A gate whose truth is the renderer's own picture with noise, and its only error none."""
    folder = tmp_path_factory.mktemp("gate")

    def make(budget, noise=NOISE, brighter=1.0):
        (folder / "small.toml").write_text(small_suite(size=(48, 36), budget=budget))
        job = Job(str(folder / "small.toml"), folder / "out", folder / "store")
        (entry,) = job.entries
        frame = Renderer(technique("paper"), repeats=0).render(entry.case)
        rng = np.random.default_rng(3)
        batches = []
        for _ in range(POOL):
            spread = 1 + noise * rng.normal(size=(*frame.rgb.shape[:2], 1))
            traced = (frame.rgb * spread * brighter).astype(np.float32)
            told = frame.provenance | {"samples": 16}
            batches.append(replace(frame, rgb=traced, provenance=told))
        truths = {"unoccluded": batches, "global": batches}
        return Gate(job, [Pool(entry, truths, ("unoccluded",))])

    return make


def expected(gate, budget, noise=NOISE):
    """The gain that any of the objects catches 95 times in 100, from the noise of their light."""
    (pool,) = gate.pools
    frame = pool.batches["global"][0]
    mean = np.mean([b.rgb for b in pool.batches["global"]], axis=0)
    reach = norm.isf((1 - sidak(1e-3, gate.job.family)) / 2)
    errors = []
    for obj in pool.entry.case.judged:
        light = mean[frame.ids == pool.entry.case.index(obj.name)].mean(axis=1)
        errors.append(noise * math.sqrt((light**2).sum() / 8) / light.sum())
    errors = np.array(errors)

    def missed(gain):
        return norm.sf(((1 + gain) / (1 + budget) - 1) / errors - reach).prod() - 0.05

    return brentq(missed, budget, 1)


def test_a_planted_gain_is_caught_from_where_budget_and_noise_say(gate):
    judge = gate("energy_error = 0.05")
    limit = Seen(judge, draws(POOL, 30), GAIN, 1).limit(["paper"])
    assert limit.noiseless == pytest.approx(0.05, rel=0.04)
    assert limit.smallest == pytest.approx(expected(judge, 0.05), rel=0.03)
    assert limit.low <= limit.smallest <= limit.high
    assert limit.limited_by == "budget" and "energy_error" in limit.seen_by
    assert "hides" in limit.words


def test_a_tight_budget_leaves_a_limit_of_noise(gate):
    judge = gate("energy_error = 0.004")
    limit = Seen(judge, draws(POOL, 30), GAIN, 1).limit(["paper"])
    assert limit.limited_by == "noise"
    assert limit.low <= expected(judge, 0.004) <= limit.high < 4 * 0.004


def test_a_loss_is_caught_as_a_gain_is(gate):
    limit = Seen(gate("energy_error = 0.05"), draws(POOL, 20), GAIN, -1).limit(["paper"])
    assert limit.sign == "-" and limit.smallest == pytest.approx(0.053, rel=0.05)


def test_what_lies_on_its_budget_is_inconclusive_and_not_caught(gate):
    seen = Seen(gate("energy_error = 0.05"), draws(POOL, 20), GAIN, 1)
    assert set(seen.sets(0.05, ["paper"])) == {1}
    assert set(seen.sets(0.02, ["paper"])) == {0}
    assert set(seen.sets(0.2, ["paper"])) == {2}


def test_an_error_that_no_budget_can_see_has_no_limit_and_says_so(gate):
    """Light in total does not see which way the normals of a picture lean by nought."""
    blind = replace(GAIN, picture=lambda rgb, _: rgb)
    limit = Seen(gate("energy_error = 0.05"), draws(POOL, 20), blind, 1).limit(["paper"])
    assert (limit.smallest, limit.noiseless, limit.high) == (None, None, None)
    assert limit.limited_by == "budget" and limit.seen_by == "" and "up to 0.9" in limit.words


def test_rows_left_out_would_have_passed_every_set(gate):
    """What is asked of a row alone, and of none that is far from its budget, is the gate's word."""
    judge, orders = gate("energy_error = 0.05\nssim = 0.5"), draws(POOL, 10)
    seen = Seen(judge, orders, GAIN, 1)
    (pool,) = judge.pools
    case, words = pool.entry.case, {"fail": 2, "inconclusive": 1, "pass": 0}

    def whole(frame, order):
        batches = [pool.batches["unoccluded"][k] for k in order[:8]]
        truth = Truth(case, "unoccluded", batches, exposures_of(case, batches))
        rules = judge.job.suite.budget
        shown = {"paper": Picture("paper", frame, case.model)}
        rows = judged_rows(case, truth, shown, {}, rules, judge.job.family)
        return max(words[row.verdict] for row in rows)

    for size in (0.03, 0.05, 0.053, 0.08):
        frame = seen.frame(size, 0, "paper", "unoccluded")
        assert list(seen.sets(size, ["paper"])) == [whole(frame, order) for order in orders]


def test_the_renderer_as_it_is_raises_no_false_alarm_and_a_wrong_one_raises_them_all(gate):
    budget = "energy_error = 0.05\nenergy_local = 0.08"
    for brighter, alarms in ((1.0, 0), (0.8, 15)):
        told = false_alarms(gate(budget, brighter=brighter), draws(POOL, 15))
        assert [t.alarms for t in told] == [alarms] * 3
        assert all(t.sets == 15 and t.low <= alarms / 15 <= t.high for t in told)


def test_the_gate_looks_as_often_as_its_cap_allows(gate):
    judge = gate("energy_error = 0.05")
    assert judge.looks == [8]
    sampling = judge.job.suite.reference.model_copy(update={"max_samples": 16 * 20})
    object.__setattr__(
        judge.job, "suite", judge.job.suite.model_copy(update={"reference": sampling})
    )
    assert Gate(judge.job, []).looks == [8, 16, 20]


@pytest.mark.parametrize(
    ("budget", "told"),
    [("energy_error = 0.05", "--pool: 16: is too small a pool"), ("", "judges none")],
)
def test_what_cannot_be_measured_is_refused(budget, told, tmp_path, shadeproof):
    suite = tmp_path / "s.toml"
    suite.write_text(small_suite(most=16 * 9, size=(32, 24), budget=budget))
    folders = ("--out", tmp_path / "out", "--store", tmp_path / "store")
    code, _, err = shadeproof("limits", "--suite", suite, *folders, "--pool", 18 - 2 * bool(budget))
    assert code == 2 and told in err and len(err.splitlines()) == 1
