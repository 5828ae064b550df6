"""Intervals: right width, right coverage, no bias."""

import numpy as np
import pytest

from reports.noise import grouped, jackknife, unbiased_square


def test_the_jackknife_of_a_mean_is_students_interval():
    values = np.array([1.0, 2.0, 4.0, 7.0])
    estimate = jackknife(lambda keep: values[keep].mean(), 4)
    assert estimate.value == 3.5
    reach = 3.182446 * values.std(ddof=1) / 2
    assert estimate.half_width == pytest.approx(reach, rel=1e-6)


def test_intervals_of_a_ratio_cover_95_percent():
    rng = np.random.default_rng(3)
    hits = 0
    for _ in range(600):
        lights = rng.gamma(20, 1 / 20, 8)
        estimate = jackknife(lambda keep, x=lights: 1 / x[keep].mean() - 1, 8)
        hits += estimate.low <= 0 <= estimate.high
    assert 0.90 <= hits / 600 <= 0.99


def test_unbiased_square_takes_the_variance_out():
    rng = np.random.default_rng(5)
    errors = 0.1 + rng.normal(0, 1, (8, 200_000))
    assert unbiased_square(errors).mean() == pytest.approx(0.01, abs=0.003)
    assert (errors.mean(axis=0) ** 2).mean() > 0.1


def test_one_batch_gives_no_interval():
    estimate = jackknife(lambda keep: 1.0, 1)
    assert np.isnan(estimate.low)
    assert np.isnan(estimate.high)


def test_groups_are_of_equal_size():
    batches = np.arange(11.0)[:, None]
    assert grouped(batches, 4).ravel().tolist() == [0.5, 2.5, 4.5, 6.5]
    assert len(grouped(batches, 99)) == 11
