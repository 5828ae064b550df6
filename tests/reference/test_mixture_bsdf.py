"""The plugin `mixture`: its values, direction by direction, and its sampling."""

import drjit as dr
import numpy as np
import pytest

from reference.mixture import D_beckmann, D_ggx, projected_area_beckmann
from reference.variant import mitsuba
from tests.reference import formula
from tests.reference.evaluating import chi2, directions, evaluate

mi = mitsuba()

ALBEDO, F0 = [0.6, 0.3, 0.1], [0.04, 0.2, 0.9]
SMOOTH_AND_ROUGH = (0.01, 0.09, 0.49, 1.0)


def mixture(alpha, weight, weight_g=None, albedo=ALBEDO, f0=F0, masking="paper"):
    weight_g = weight if weight_g is None else weight_g
    parameters = {"albedo": albedo, "f0": f0, "alpha": alpha, "weight": weight}
    model = {"fresnel": "schlick", "kd": "one-minus-fresnel", "masking": masking}
    return mi.load_dict({"type": "mixture", "weight_g": weight_g, **model, **parameters})


@pytest.mark.parametrize("alpha", SMOOTH_AND_ROUGH)
@pytest.mark.parametrize("masking", ["paper", "smith"])
@pytest.mark.parametrize(("weight", "weight_g"), [(1, 1), (0, 0), (0.3, 0.7), (1, 0)])
def test_values_are_the_formula_in_every_direction(alpha, weight, weight_g, masking):
    wi, wo = directions(alpha)
    parameters = (ALBEDO, F0, alpha, weight, weight_g, masking)
    expected = formula.brdf(wi, wo, *parameters) * wo[:, 2:]
    found = evaluate(mixture(alpha, weight, weight_g, masking=masking), wi, wo)
    # A float32 direction is known to 6e-8, and D at alpha .01 amplifies that a thousandfold.
    scale = np.maximum(expected, 1e-4 * expected.max(axis=0))
    assert np.max(np.abs(found - expected) / scale) < 1e-4


def test_a_light_below_the_horizon_gives_nothing():
    wi = np.array([[0.6, 0, 0.8], [0.6, 0, -0.8], [0.6, 0, -0.8]])
    wo = np.array([[0, 0.6, -0.8], [0, 0.6, 0.8], [0, 0.6, -0.8]])
    assert np.all(evaluate(mixture(0.3, 0.5), wi, wo) == 0)


@pytest.mark.parametrize("alpha", SMOOTH_AND_ROUGH)
def test_ggx_alone_with_full_fresnel_is_mitsubas_perfect_rough_conductor(alpha):
    stock = {"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": alpha}
    wi, wo = directions(max(alpha, 0.05))
    expected = evaluate(mi.load_dict(stock), wi, wo)
    found = evaluate(mixture(alpha, 1, albedo=[0] * 3, f0=[1] * 3), wi, wo)
    # The stock plugin drops a D cos below 1e-20 and is itself float32.
    assert np.max(np.abs(found - expected) / np.maximum(expected, 1e-4 * expected.max())) < 1e-4


@pytest.mark.parametrize("alpha", SMOOTH_AND_ROUGH)
def test_each_ndf_is_mitsubas(alpha):
    wi, wo = directions(alpha)
    h = wi + wo
    h = mi.Normal3f((h / np.linalg.norm(h, axis=1, keepdims=True)).T.astype(np.float32))
    for kind, ours in (("GGX", D_ggx), ("Beckmann", D_beckmann)):
        stock = mi.MicrofacetDistribution(getattr(mi.MicrofacetType, kind), alpha)
        expected, found = stock.eval(h).numpy(), ours(h, mi.Float(alpha)).numpy()
        assert np.max(np.abs(found - expected)) < 1e-4 * expected.max()


def test_the_area_that_beckmann_facets_show_is_mitsubas():
    cosine = np.linspace(0.02, 1, 200, dtype=np.float32)
    w = mi.Vector3f(np.sqrt(1 - cosine**2), 0, cosine)
    for alpha in (0.09, 0.49, 1.0):
        stock = mi.MicrofacetDistribution(mi.MicrofacetType.Beckmann, alpha)
        expected = cosine / stock.smith_g1(w, mi.Vector3f(0, 0, 1)).numpy()
        found = projected_area_beckmann(w, mi.Float(alpha)).numpy()
        assert np.max(np.abs(found / expected - 1)) < 4e-3  # theirs is a rational fit, .35 % off


CHI2 = [
    (alpha, weight, albedo, angle)
    for alpha in (0.1, 0.36, 1.0)
    for weight in (0.0, 0.4, 1.0)
    for albedo in ([0.0] * 3, [0.7] * 3)
    for angle in (15, 60, 85)
]


@pytest.mark.parametrize(("alpha", "weight", "albedo", "angle"), CHI2)
def test_samples_have_the_density_that_pdf_says(
    alpha, weight, albedo, angle, monkeypatch, tmp_path
):
    monkeypatch.chdir(tmp_path)  # where a failing test leaves its histogram
    bsdf = mixture(alpha, weight, albedo=albedo, f0=[0.3] * 3)
    test = chi2(bsdf, angle)
    # Sidak's correction over the parameters, in `test_count`.
    assert test.run(significance_level=0.01, test_count=len(CHI2), quiet=True), test.messages


@pytest.mark.parametrize("weight", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("alpha", [0.01, 0.25])
def test_sampling_estimates_the_same_albedo_as_a_uniform_grid(alpha, weight):
    # A sampled weight is f cos / pdf: its mean is the directional albedo.
    count, cosine = 1 << 18, 0.6
    bsdf = mixture(alpha, weight)
    si = dr.zeros(mi.SurfaceInteraction3f, count)
    si.wi = mi.Vector3f(0.8, 0, cosine)
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(1, count)
    drawn = bsdf.sample(mi.BSDFContext(), si, sampler.next_1d(), sampler.next_2d())[1].numpy()
    error = drawn.std(axis=1) / count**0.5
    steps = 400 if alpha > 0.1 else 3000
    expected = formula.directional_albedo(cosine, ALBEDO, F0, alpha, weight, weight, steps=steps)
    assert np.all(np.abs(drawn.mean(axis=1) - expected) < 4.5 * error + 2e-4)
