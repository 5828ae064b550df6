"""The figures: against published values, exact cases, and pictures known to be wrong."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from skimage.metrics import structural_similarity

from reports.display import display, exposure_for
from reports.metrics import METRICS, chroma, energy, flip, relmse, ssim
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
        energy.figures(subject(truth, noisy(truth, 8, 0.5, seed)))["energy_local"]
        for seed in range(20)
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
    assert energy.energy_local(subject(half + 0.2, np.stack([half] * 8))).value > 0.3**2


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


WRONG = {
    "right": lambda truth: truth,
    "blurred": lambda truth: gaussian_filter(truth, (1.5, 1.5, 0)),
    "brighter": lambda truth: truth * 1.05,
    "tilted": lambda truth: truth * np.linspace(0.8, 1.2, SIDE)[None, :, None],
    "hue-shifted": lambda truth: truth * np.array([1.08, 1, 0.92]),
}
NOISY_FIGURES = (
    ("ssim", "ssim_ci95"),
    ("ssim_highlights", "ssim_highlights_ci95"),
    ("energy_error", "energy_ci95"),
    ("energy_local", "energy_local_ci95"),
    ("relmse", "relmse_ci95"),
)


@pytest.mark.parametrize("change", WRONG)
def test_intervals_cover_the_truth_for_right_and_wrong_candidates(change):
    """At heavy-tailed noise; 40 resamplings bound a coverage of .95 to within .1."""
    truth = picture() + 0.05
    candidate = WRONG[change](truth)
    clean = {}
    for figures in (ssim.figures, energy.figures, relmse.figures):
        clean |= figures(subject(candidate, np.stack([truth] * 8)))
    hits = dict.fromkeys((name for name, _ in NOISY_FIGURES), 0)
    for seed in range(40):
        rng = np.random.default_rng(seed)
        batches = (truth * rng.gamma(25, 1 / 25, (8, *truth.shape))).astype(np.float32)
        measured = {}
        for figures in (ssim.figures, energy.figures, relmse.figures):
            measured |= figures(subject(candidate, batches))
        for name, interval in NOISY_FIGURES:
            low, high = measured[interval]
            hits[name] += low - 1e-6 <= clean[name] <= high + 1e-6
    assert min(hits.values()) >= 0.85 * 40, hits


def test_every_figure_has_an_interval_that_holds_it():
    measured = {}
    for figures in METRICS:
        measured |= figures(subject(picture() * 1.1, noisy(picture(), 8, 0.1)))
    for name in ("ssim", "ssim_raw", "ssim_p5", "ssim_highlights", "energy_local", "relmse",
                 "relmse_median", "flip"):  # fmt: skip
        low, high = measured[f"{name}_ci95"]
        assert low < measured[name] < high, name
    low, high = measured["energy_ci95"]
    assert low < measured["energy_error"] < high
    for value, (low, high) in zip(measured["energy_rgb"], measured["energy_rgb_ci95"], strict=True):
        assert low < value < high


def test_the_derivative_of_ssim_is_that_of_its_differences():
    """By which its standard error stands: one pixel of half A moved, inside and outside."""
    truth = TruthView(noisy(picture(), 8, 0.1), mask(), 1.0)
    shown = ssim.shown_at(truth, 1.0)
    candidate = ssim._Candidate(subject(picture() * 1.1, truth.batches), 1.0)
    weights = truth.core / truth.core.sum()

    def similarity(a):
        return (
            ssim.Map(candidate, ssim.Moments(a, shown.b.image, mask())).value.mean(axis=2) * weights
        ).sum(dtype=np.float64)

    by_a, _ = ssim.Map(candidate, shown.pair).gradients(weights)
    for place in ((40, 40, 1), (9, 50, 0), (6, 30, 2)):
        moved = [shown.a.image.astype(np.float64) for _ in range(2)]
        moved[0][place] += 1e-3
        moved[1][place] -= 1e-3
        slope = (similarity(moved[0]) - similarity(moved[1])) / 2e-3
        assert slope == pytest.approx(by_a[place], rel=0.02, abs=1e-8)


def test_denominators_that_noise_spoils_are_unknown_and_never_sure():
    """One sample per pixel and heavy tails: nothing is claimed; little noise: all is."""
    truth = picture() + 0.05
    rng = np.random.default_rng(3)
    wild = (truth * rng.gamma(0.02, 1 / 0.02, (8, *truth.shape))).astype(np.float32)
    measured = ssim.figures(subject(truth, wild)) | energy.figures(subject(truth, wild))
    for name in ("ssim_ci95", "ssim_p5_ci95", "ssim_highlights_ci95", "energy_local_ci95"):
        assert np.isnan(measured[name]).all(), name
    low, high = measured["energy_ci95"]
    assert low < 0 < high


def test_flip_bounds_hold_the_figure_without_noise():
    truth = picture() + 0.05
    for candidate in (truth, truth * 1.05, np.roll(truth, 1, axis=0)):
        clean = flip.figures(subject(candidate, np.stack([truth] * 8)))["flip"]
        low, high = flip.figures(subject(candidate, noisy(truth, 8, 0.1)))["flip_ci95"]
        assert low <= clean <= high


def test_flip_of_pictures_side_by_side_is_that_of_each_alone():
    truth = noisy(picture(), 8, 0.1)
    whole = subject(picture(), truth)
    part = np.s_[20:70, 10:60]  # narrower, and at another exposure
    view = TruthView(truth[(slice(None), *part)], mask()[part], 3.0)
    narrow = Subject(whole.candidate[part], view)
    for shown, alone in zip(flip.flip_maps([whole, narrow]), (whole, narrow), strict=True):
        apart = np.abs(shown - flip.flip_maps([alone])[0])
        assert apart[alone.truth.mask].max() < 1e-5


def test_flip_sees_exposed_pictures():
    """A picture half as bright, shown twice as bright, is the same."""
    truth = noisy(picture(), 8, 0.1)
    bright, dim = (
        Subject(s * (picture() * 1.1), TruthView(s * truth, mask(), 1 / s)) for s in (1.0, 0.5)
    )
    assert flip.figures(bright)["flip"] == pytest.approx(flip.figures(dim)["flip"], rel=1e-4)


def test_chroma_tells_a_dull_picture_from_a_dark_one():
    red = np.broadcast_to([0.4, 0.05, 0.04], (96, 96, 3)).astype(np.float32)
    grey = red.mean(axis=2, keepdims=True)
    same = chroma.figures(subject(red, noisy(red, 8, 0.05)))
    low, high = same["chroma_error_ci95"]
    assert low <= 0 <= high
    assert high - low < 0.01
    dull = chroma.figures(subject(0.8 * red + 0.2 * grey, noisy(red, 8, 0.05)))
    assert dull["chroma_error"] < -0.1
    colourless = chroma.figures(subject(red, np.stack([0 * red + 0.2] * 8)))
    assert np.isnan(colourless["chroma_error"])
