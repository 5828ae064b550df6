"""The figures: against published values, exact cases, and pictures known to be wrong."""

import numpy as np
import pytest
from skimage.metrics import structural_similarity

from reports.display import display, exposure_for
from reports.metrics import energy, relmse, ssim
from reports.metrics.subject import Subject, TruthView

RNG = np.random.default_rng(7)
SIDE = 96


def picture():
    """A smooth object with some detail, (96, 96, 3)."""
    y, x = np.mgrid[:SIDE, :SIDE] / SIDE
    base = 0.2 + 0.15 * np.sin(9 * x + 4 * y) + 0.05 * np.sin(40 * y)
    return np.stack([base, 0.8 * base, 0.5 * base + 0.05], axis=2).astype(np.float32)


def mask():
    inside = np.zeros((SIDE, SIDE), bool)
    inside[8:88, 8:88] = True
    return inside


def noisy(truth, count, sigma, seed=1):
    rng = np.random.default_rng(seed)
    noise = rng.normal(0, sigma, (count, *truth.shape)) * truth
    return (truth + noise).astype(np.float32)


def subject(candidate, batches):
    truth = TruthView(batches, mask(), 1.0)
    return Subject(np.asarray(candidate, np.float32), truth)


def test_display_is_the_srgb_curve_with_clipping():
    shown = display(np.array([0.0, 0.0031308, 0.18, 1.0, 7.0]), 1.0)
    assert shown == pytest.approx([0, 0.04045, 0.46136, 1, 1], abs=2e-5)


def test_exposure_puts_the_median_luminance_at_middle_grey():
    truth = picture()
    exposure = exposure_for(truth, mask())
    luminance = (truth * exposure)[mask()] @ [0.2126, 0.7152, 0.0722]
    assert np.median(luminance) == pytest.approx(0.18, rel=1e-6)


def test_ssim_without_noise_is_scikit_images():
    truth, blurred = picture(), np.roll(picture(), 1, axis=0)
    measured = ssim.figures(subject(blurred, np.stack([truth] * 8)))
    joined = np.where(mask()[..., None], blurred, truth)
    _, full = structural_similarity(
        display(truth, 1),
        display(joined, 1),
        gaussian_weights=True,
        sigma=1.5,
        use_sample_covariance=False,
        data_range=1,
        channel_axis=2,
        full=True,
    )
    core = np.zeros_like(mask())
    core[9:87, 9:87] = True
    assert measured["ssim"] == pytest.approx(full[core].mean(), abs=1e-5)
    assert measured["ssim_raw"] == pytest.approx(full[core].mean(), abs=1e-6)


@pytest.mark.parametrize("change", ["none", "gain", "shift"])
def test_ssim_of_noisy_batches_is_that_of_the_clean_truth(change):
    truth = picture()
    candidate = {
        "none": truth,
        "gain": truth * 1.05,
        "shift": np.roll(truth, 1, axis=0),
    }[change]
    clean = ssim.figures(subject(candidate, np.stack([truth] * 8)))["ssim"]
    measured = ssim.figures(subject(candidate, noisy(truth, 16, 0.2)))
    assert measured["ssim"] == pytest.approx(clean, abs=0.004)
    assert measured["ssim_raw"] < clean - 0.004  # the plain figure does see the noise


def test_ssim_claims_nothing_where_noise_drowns_the_picture():
    flat = np.full((SIDE, SIDE, 3), 0.2, np.float32)
    measured = ssim.figures(subject(flat, noisy(flat, 8, 1.0)))
    assert np.isnan(measured["ssim_ci95"]).all()
    assert not np.isnan(ssim.figures(subject(flat, noisy(flat, 8, 0.01)))["ssim_ci95"]).any()


def test_energy_error_is_the_gain():
    truth = picture()
    measured = energy.figures(subject(truth * 1.05, noisy(truth, 8, 0.1)))
    low, high = measured["energy_ci95"]
    assert low <= 0.05 <= high
    assert high - low < 0.01


def test_a_tilted_picture_keeps_its_energy_and_fails_local_energy():
    truth = picture()
    tilt = np.where(np.arange(SIDE) < SIDE // 2, 1.3, 0.7)[None, :, None]
    measured = energy.figures(subject(truth * tilt, np.stack([truth] * 8)))
    assert abs(measured["energy_error"]) < 0.07
    assert measured["energy_local"] == pytest.approx(0.3, abs=0.01)


def test_local_energy_sees_a_hue_shift_that_total_energy_misses():
    truth = np.full((SIDE, SIDE, 3), 0.3, np.float32)
    shifted = truth * np.array([1.2, 1.0, 0.8], np.float32)
    measured = energy.figures(subject(shifted, np.stack([truth] * 8)))
    assert measured["energy_error"] == pytest.approx(0, abs=1e-6)
    assert measured["energy_local"] == pytest.approx(0.2, abs=1e-6)


def test_local_energy_of_a_perfect_candidate_is_not_the_noise():
    truth = picture()
    estimates = [
        energy.energy_local(subject(truth, noisy(truth, 8, 0.5, seed))).value for seed in range(20)
    ]
    blind = np.sqrt(np.mean([(0.5 / np.sqrt(8 * 256)) ** 2]))  # what noise alone would give
    assert np.sqrt(np.mean(np.square(estimates))) < blind


def test_relmse_is_unbiased():
    truth = picture()
    clean = relmse.figures(subject(truth * 1.1, np.stack([truth] * 8)))["relmse"]
    measured = [
        relmse.figures(subject(truth * 1.1, noisy(truth, 8, 0.1, seed)))["relmse"]
        for seed in range(10)
    ]
    assert np.mean(measured) == pytest.approx(clean, rel=0.01)


def test_what_lies_outside_the_object_changes_nothing():
    truth = picture()
    changed = truth.copy()
    changed[~mask()] = 50
    same = subject(truth, np.stack([truth] * 8))
    other = subject(changed, np.stack([truth] * 8))
    for figures in (ssim.figures, energy.figures, relmse.figures):
        assert figures(same) == figures(other)


def test_a_channel_without_light_does_not_hide_the_others():
    truth = picture() * np.array([1, 1, 0], np.float32)
    tilt = np.where(np.arange(SIDE) < SIDE // 2, 1.9, 0.1)[None, :, None]
    measured = energy.figures(subject(truth * tilt, np.stack([truth] * 8)))
    assert measured["energy_local"] == pytest.approx(0.9, abs=0.01)


def test_light_where_the_truth_is_black_is_an_error():
    truth = np.zeros((SIDE, SIDE, 3), np.float32)
    assert energy.energy_local(subject(truth + 1, np.stack([truth] * 8))).value == np.inf
    assert energy.energy_local(subject(truth, np.stack([truth] * 8))).value == 0
    half = picture()
    half[:, : SIDE // 2] = 0
    assert energy.energy_local(subject(half + 0.2, np.stack([half] * 8))).value > 0.3


def test_relmse_of_the_truth_itself_is_nought_whatever_the_noise():
    truth = picture() + 0.1
    for sigma in (0.1, 0.4):
        measured = relmse.figures(subject(truth, noisy(truth, 8, sigma)))
        assert abs(measured["relmse"]) < 0.02 * sigma**2
        assert abs(measured["relmse_median"]) < 0.02 * sigma**2


def test_noise_around_a_thin_object_does_not_raise_its_ssim():
    truth = picture() + 0.1
    stripe = np.zeros((SIDE, SIDE), bool)
    stripe[:, 40:48] = True
    batches = noisy(truth, 8, 0.4)
    batches[:, stripe] = noisy(truth, 8, 0.05, seed=2)[:, stripe]
    thin = Subject(truth, TruthView(batches, stripe, 1.0))
    assert ssim.figures(thin)["ssim"] == pytest.approx(1, abs=0.003)
