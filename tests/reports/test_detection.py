"""The smallest size that is caught: found where noise and limit are known."""

import math

import numpy as np
import pytest
from scipy.stats import norm

from reports.limits.detection import (
    CAUGHT,
    INCONCLUSIVE,
    PASSED,
    draws,
    noiseless,
    share_interval,
    traced,
)

BUDGET, REACH = 0.05, 4.0  # an interval reaches 4 standard errors, as of some 200 verdicts at 1e-3


def judging(rng, noise, taken=8, pool=32, sets=100):
    """The gate on one figure that is off by an error's size, with normal noise in a set's mean."""
    batches = rng.normal(0, noise * math.sqrt(taken), pool)
    off = batches[draws(pool, sets, int(rng.integers(1 << 30)))[:, :taken]].mean(axis=1)

    def judge(size, asked):
        over = (size - off[asked] - BUDGET) / noise
        return np.where(over > REACH, CAUGHT, np.where(over > -REACH, INCONCLUSIVE, PASSED))

    return judge


@pytest.mark.parametrize(("noise", "pool"), [(0.02, 32), (0.002, 32), (0.02, 16)])
def test_the_known_limit_is_found_without_bias_and_within_its_interval(noise, pool):
    rng = np.random.default_rng(5)
    known = BUDGET + noise * (REACH + norm.ppf(0.95))
    found = [traced(judging(rng, noise, pool=pool), BUDGET, 1.0).limit(8, pool) for _ in range(60)]
    assert np.mean([f for f, _, _ in found]) == pytest.approx(known, rel=0.03)
    assert np.mean([low <= known <= high for _, low, high in found]) >= 0.88


def test_without_noise_the_limit_is_the_budget_within_the_step_of_sizes():
    curve = traced(judging(np.random.default_rng(5), 1e-6), BUDGET, 1.0)
    found, low, high = curve.limit(8, 32)
    assert low <= BUDGET <= high < 1.05 * BUDGET and low <= found <= high


def test_what_is_never_caught_has_no_limit_but_what_was_tried():
    curve = traced(lambda *_: np.full(20, INCONCLUSIVE), BUDGET, 0.4)
    assert curve.limit(8, 32) == (None, 0.4, None)


def test_the_curve_reaches_from_less_than_half_of_the_sets_to_nearly_all():
    curve = traced(judging(np.random.default_rng(2), 0.01), 3 * BUDGET, 1.0)
    shares = [curve.share(size) for size in curve.sizes]
    assert shares[0] < 0.5 and shares[-1] >= 0.95


def test_no_set_holds_a_batch_twice_and_sets_differ():
    orders = draws(32, 50)
    assert (np.sort(orders, axis=1) == np.arange(32)).all()
    assert len({tuple(order[:8]) for order in orders}) == 50


def test_a_size_counts_only_where_all_larger_ones_are_caught():
    """An error that first makes up for the renderer's own and then passes over it."""
    found = noiseless(lambda size: abs(size - 0.2) - 0.1, 1.0)
    assert found == pytest.approx(0.3, rel=0.01)
    assert noiseless(lambda size: 0.1 - size, 1.0) is None
    assert noiseless(lambda size: size, 1.0) == 4**-6


def test_no_alarm_in_300_bounds_the_share_by_one_and_a_quarter_percent():
    low, high = share_interval(0, 300)
    assert low == 0 and high == pytest.approx(1 - 0.025 ** (1 / 300))
    assert share_interval(3, 300)[0] > 0
