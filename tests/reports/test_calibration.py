"""The experiment itself: it sees intervals that hold, and those that do not."""

import numpy as np
import pytest

from reports.calibration import (
    FEW,
    HELD,
    INTERVALS,
    TRUTH,
    Pool,
    coverage,
    flips,
    resample,
    unstable,
)

SIDE = 64


def pool(shared=0.0):
    """A pool of independent noise, or with a part that neighbouring pixels share."""
    rng = np.random.default_rng(11)
    y, x = np.mgrid[:SIDE, :SIDE] / SIDE
    truth = (0.2 + 0.1 * np.sin(9 * x + 4 * y))[..., None] * np.array([1, 0.8, 0.5])
    count = FEW + TRUTH + HELD
    noise = rng.gamma(100, 1 / 100, (count, SIDE, SIDE, 3)) - 1
    gain = 1 + shared * rng.normal(size=(count, 1, 1, 1))
    mask = np.zeros((SIDE, SIDE), bool)
    mask[8:56, 8:56] = True
    coarse = truth * rng.gamma(0.02, 50, (8, SIDE, SIDE, 3))
    return Pool("p", (truth * (1 + noise) * gain).astype(np.float32), mask, coarse)


@pytest.fixture(scope="module")
def records():
    return resample(pool(), 20)


def test_intervals_of_independent_noise_hold_for_every_candidate(records):
    for record in records:
        for figure in ("ssim", "energy_error", "energy_local", "relmse"):
            assert coverage(record, figure)[4] >= 0.75, (record.candidate, figure)


def test_ssim_agrees_with_sixteen_times_the_samples(records):
    for record in records:
        _, mean, largest, _, _ = coverage(record, "ssim")
        assert abs(mean) < 0.001
        assert largest < 0.004


def test_no_budget_near_the_truth_is_both_passed_and_failed(records):
    assert [flips(r, f) for r in records for f in ("ssim", "energy_error", "energy_local")] == [
        0
    ] * 3 * len(records)


def test_noise_that_pixels_share_is_seen_not_to_be_covered():
    shared = resample(pool(shared=0.02), 10)
    assert coverage(shared[0], "energy_error")[4] < 0.6


def test_single_samples_give_no_sure_wrong_figure():
    for _, figure, _, (low, high), truth in unstable(pool()):
        assert np.isnan(low) or low <= truth <= high, figure
    assert any(np.isnan(low) for _, _, _, (low, _), _ in unstable(pool()))


def test_every_interval_of_the_experiment_is_a_field_of_a_row():
    from reports.results import Row

    assert {*INTERVALS, *INTERVALS.values()} <= Row.model_fields.keys()
