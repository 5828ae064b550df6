"""Standard errors: right size, right degrees of freedom, right coverage, no bias."""

import math

import numpy as np
import pytest

from reports.noise import (
    Estimate,
    combined,
    corrected,
    grouped,
    jackknife,
    near_quantile,
    pairs,
    pairs_excess,
    pairs_without_each,
    quantile,
    sidak,
    without_each,
)


def products(errors):
    return errors[:, None] * errors


def test_the_jackknife_of_a_mean_is_students_interval():
    values = np.array([1.0, 2.0, 4.0, 7.0])
    se, dof = combined(jackknife(without_each(values)[:, None]), 3)
    low, high = Estimate(values.mean(), se, dof).interval()
    assert (high - low) / 2 == pytest.approx(3.182446 * values.std(ddof=1) / 2, rel=1e-6)
    assert (high + low) / 2 == 3.5


def test_degrees_of_freedom_of_equal_cells_add_up_and_one_large_cell_counts_alone():
    assert combined(np.ones(50), 7) == pytest.approx((math.sqrt(50), 350))
    assert combined(np.array([1e6, 1, 1]), 7)[1] == pytest.approx(7, rel=1e-3)


@pytest.mark.parametrize("confidence", [0.95, 0.999])
def test_sums_over_independent_cells_are_covered(confidence):
    rng = np.random.default_rng(3)
    hits = 0
    for _ in range(2000):
        batches = rng.gamma(0.5, 2, (8, 300))
        se, dof = combined(jackknife(without_each(batches)), 7)
        low, high = Estimate(batches.mean(axis=0).sum(), se, dof).interval(confidence)
        hits += low <= 300 <= high
    assert hits / 2000 == pytest.approx(confidence, abs=0.012 if confidence == 0.95 else 0.003)


def test_pairs_take_the_variance_out():
    rng = np.random.default_rng(5)
    errors = 0.1 + rng.normal(0, 1, (8, 200_000))
    assert pairs(products(errors)).mean() == pytest.approx(0.01, abs=0.003)
    assert (errors.mean(axis=0) ** 2).mean() > 0.1


def test_pairs_without_each_are_pairs_of_the_others():
    errors = np.random.default_rng(6).normal(size=(5, 3))
    others = pairs_without_each(products(errors))
    for k in range(5):
        assert others[k] == pytest.approx(pairs(products(np.delete(errors, k, axis=0))))


@pytest.mark.parametrize("mean", [0.0, 0.2, 3.0])
def test_the_jackknife_of_pairs_less_its_excess_is_their_variance(mean):
    rng = np.random.default_rng(7)
    p = products(mean + rng.normal(0, 1, (8, 100_000)))
    variance = pairs(p).var()
    told = jackknife(pairs_without_each(p)) - pairs_excess(p)
    assert told.mean() == pytest.approx(variance, rel=0.03)
    if mean == 0:  # two noises make it all, and the plain jackknife is far too large
        assert jackknife(pairs_without_each(p)).mean() > 1.8 * variance


def test_the_correction_takes_the_bias_of_a_curve_out():
    batches = np.random.default_rng(8).gamma(4, 0.25, (8, 100_000))
    plain = np.sqrt(batches.mean(axis=0))
    better = corrected(plain, np.sqrt(without_each(batches)))
    assert abs(plain.mean() - 1) > 0.003
    assert abs(better.mean() - 1) < 0.0005


def test_weights_of_a_quantile_lie_around_it():
    values = np.random.default_rng(9).permutation(1000.0 + np.arange(1000))
    near = near_quantile(values, 0.05, 0.02)
    assert near.sum() == pytest.approx(1)
    assert values[near > 0].min() == pytest.approx(1029, abs=1)
    assert values[near > 0].max() == pytest.approx(1069, abs=1)


def test_without_degrees_of_freedom_there_is_no_interval():
    assert np.isnan(Estimate(1.0, 0.1, 0).interval()).all()
    assert np.isnan(Estimate(1.0, math.nan, 7).interval()).all()
    assert Estimate(1.0, 0.0, 0).interval() == (1.0, 1.0)


def test_a_family_of_hundreds_needs_no_more_than_five_standard_errors_or_so():
    level = sidak(1e-3, 800)
    assert level**800 == pytest.approx(0.999)
    assert quantile(level, 400) == pytest.approx(4.94, abs=0.03)
    assert quantile(level, 7) > 14  # what eight batches alone would ask


def test_groups_are_of_equal_size():
    batches = np.arange(11.0)[:, None]
    assert grouped(batches, 4).ravel().tolist() == [0.5, 2.5, 4.5, 6.5]
    assert len(grouped(batches, 99)) == 11
