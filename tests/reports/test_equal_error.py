"""Equal error: known answers, what lies beyond the measured, and whether intervals hold."""

import math

import numpy as np
import pytest

from reports.noise import Estimate
from reports.speed.equal_error import Curve, need

K = np.array([1.0, 2, 4, 8, 16, 36, 64])
ROUNDS = 9


def curve(error, spread=0.0, noise=0.0, seconds=None, rng=None):
    """Three pictures at each k of an error by k, and seconds .01 + .015 k in each round."""
    rng = rng or np.random.default_rng(0)
    errors = error(K)[:, None] * (1 + spread * rng.standard_normal((len(K), 3)))
    errors += noise * rng.standard_normal(len(K))[:, None]
    if seconds is None:
        seconds = np.repeat((0.01 + 0.015 * K)[:, None], ROUNDS, axis=1)
    return Curve(K, errors, np.full(len(K), noise), seconds)


def falling(k):
    return 0.04 * k**-1.1


@pytest.mark.parametrize("law", ["power", "monotone"])
def test_a_known_curve_gives_its_samples_and_seconds(law):
    frames = np.full(ROUNDS, 0.05)
    found = need(Estimate(falling(10.0)), frames, curve(falling), law)
    assert found.beyond == ""
    assert found.samples.value == pytest.approx(10, rel=1e-6)
    assert found.seconds.value == pytest.approx(0.01 + 0.15)
    assert found.ratio.value == pytest.approx(0.16 / 0.05)
    assert found.ratio.low == pytest.approx(found.ratio.high)  # nothing is noisy


def test_only_a_law_is_followed_beyond_what_was_measured():
    target, frames = Estimate(falling(500.0)), np.full(ROUNDS, 0.05)
    by_law = need(target, frames, curve(falling), "power")
    assert by_law.beyond == "above" and by_law.samples.value == pytest.approx(500)
    measured = need(target, frames, curve(falling), "monotone")
    assert measured.beyond == "above" and math.isnan(measured.samples.value)


@pytest.mark.parametrize("law", ["power", "monotone"])
def test_an_error_worse_than_at_one_sample_needs_none(law):
    found = need(Estimate(falling(0.5)), np.full(ROUNDS, 0.05), curve(falling), law)
    assert found.beyond == "below"
    assert all(math.isnan(f.value) for f in (found.samples, found.seconds, found.ratio))


def test_a_denoiser_that_stops_getting_better_is_never_as_good():
    found = need(
        Estimate(0.001), np.full(ROUNDS, 0.05), curve(lambda k: 0.1 / k + 0.01), "monotone"
    )
    assert found.beyond == "above"


def test_one_lucky_number_of_samples_does_not_decide():
    lucky = curve(falling)
    lucky.errors[2] *= 0.4  # 4 samples better than 8
    found = need(Estimate(falling(8.9)), np.full(ROUNDS, 0.05), lucky, "monotone")
    assert found.samples.value == pytest.approx(8.9, rel=0.1)


def test_unknown_noise_leaves_the_figure_without_an_interval():
    target = Estimate(falling(10.0), math.nan)
    found = need(target, np.full(ROUNDS, 0.05), curve(falling), "monotone")
    assert found.samples.value == pytest.approx(10)
    assert math.isnan(found.samples.low) and math.isnan(found.ratio.high)


def test_seconds_of_samples_that_were_measured_are_those_that_were_measured():
    times = np.repeat((0.01 + 0.015 * K)[:, None], ROUNDS, axis=1)
    times[5] *= 1.2  # 36 is dearer than a line through the others says
    frames = np.full(ROUNDS, 0.05)
    found = need(Estimate(falling(36.0)), frames, curve(falling, seconds=times), "power")
    assert found.seconds.value == pytest.approx(1.2 * 0.55)
    between = need(Estimate(falling(50.0)), frames, curve(falling, seconds=times), "power")
    assert between.seconds.value == pytest.approx(np.interp(50, K, times[:, 0]))


def test_beyond_the_most_samples_time_goes_on_along_the_line():
    found = need(Estimate(falling(500.0)), np.full(ROUNDS, 0.05), curve(falling), "power")
    assert found.seconds.value == pytest.approx(0.01 + 0.015 * 500)
    never = need(Estimate(-1.0), np.full(ROUNDS, 0.05), curve(falling), "power")
    assert math.isnan(never.seconds.value)


@pytest.mark.parametrize("law", ["power", "monotone"])
def test_a_truth_of_unknown_noise_leaves_the_figure_without_an_interval(law):
    told = curve(falling)
    told.noise[:] = math.nan
    found = need(Estimate(falling(10.0), 0.001), np.full(ROUNDS, 0.05), told, law)
    assert found.samples.value == pytest.approx(10) and found.beyond == ""
    assert math.isnan(found.samples.low) and math.isnan(found.ratio.high)
    assert need(Estimate(9.0, 0.1), np.full(ROUNDS, 0.05), told, law).beyond == "below"


def test_noise_that_swallows_the_curve_gives_nothing():
    found = need(Estimate(0.01), np.full(ROUNDS, 0.05), curve(falling, noise=1.0), "monotone")
    assert math.isnan(found.samples.value)


def test_a_machine_that_slows_down_leaves_the_ratio_alone():
    slow = np.linspace(1, 3, ROUNDS)
    times = (0.01 + 0.015 * K)[:, None] * slow
    found = need(Estimate(falling(10.0)), 0.05 * slow, curve(falling, seconds=times), "power")
    assert found.ratio.value == pytest.approx(0.16 / 0.05)
    assert found.ratio.high - found.ratio.low < 1e-9
    assert found.seconds.high > 1.5 * found.seconds.low


@pytest.mark.parametrize(
    ("law", "error", "spread", "noise"),
    [
        ("power", falling, 0.15, 2e-5),
        ("monotone", lambda k: 0.9 * k**-0.35 + 0.01, 0.006, 5e-4),
    ],
)
def test_intervals_hold_in_19_of_20_runs(law, error, spread, noise):
    rng = np.random.default_rng(3)
    held = []
    for _ in range(250):
        wanted = np.exp(rng.uniform(np.log(1.6), np.log(40)))
        se = 0.03 * error(wanted)
        target = Estimate(error(wanted) + se * rng.standard_normal(), se, 20)
        slow = np.exp(0.1 * rng.standard_normal(ROUNDS))  # all ways alike
        jitter = np.exp(0.04 * rng.standard_normal((len(K) + 1, ROUNDS)))
        times = (0.01 + 0.015 * K)[:, None] * slow * jitter[1:]
        frames = 0.05 * slow * jitter[0]
        measured = curve(error, spread, noise, times, rng)
        found = need(target, frames, measured, law, seed=int(rng.integers(2**31)))
        truths = wanted, 0.01 + 0.015 * wanted, (0.01 + 0.015 * wanted) / 0.05
        figures = found.samples, found.seconds, found.ratio
        held.append([f.low <= t <= f.high for f, t in zip(figures, truths, strict=True)])
    for share in np.mean(held, axis=0):
        assert 0.90 <= share <= 0.99
