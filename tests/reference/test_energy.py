"""What the reference's specular lobe sends back, against the harness's own quadrature."""

import numpy as np
import pytest

from reference import energy
from reports.furnace import Surface, furnace_albedo


@pytest.mark.parametrize("masking", ["paper", "smith"])
@pytest.mark.parametrize("alpha", [0.01, 0.1, 1.0])
@pytest.mark.parametrize("weight", [0.0, 0.4, 1.0])
def test_the_albedo_is_that_of_another_quadrature(masking, alpha, weight):
    mixture = Surface((alpha, alpha), np.array([weight]), masking)
    for cosine in (0.02, 0.3, 0.9):
        found = energy._albedo(
            cosine, alpha, weight, weight, masking, lambda c: energy.schlick(np.full(3, 0.04), c)
        )
        dielectric, white = furnace_albedo(mixture, np.arccos(cosine), (0.04, 1.0))[:, 0]
        np.testing.assert_allclose(found, [*[dielectric] * 3, white], atol=5e-6)


def test_factors_send_back_just_what_is_lost():
    factors, back, root = energy.lost_light(
        0.5, 0.5, 0.5, "smith", lambda c: energy.schlick(np.array([0.2, 0.5, 1.0]), c), True
    )
    # 2 ∫ factor mu dmu is the root of the mean loss.
    mu = (np.linspace(0, 1, energy.TEXELS)) ** 4
    mu = mu * (2 - mu)
    assert 2 * np.trapezoid(factors[:, 3] * mu, mu) == pytest.approx(root, rel=1e-4)
    assert back[2] == pytest.approx(1, abs=1e-6) and 0 < back[0] < back[1] < 1


def test_a_cosine_has_its_place():
    x = np.linspace(0, 1, 11)
    np.testing.assert_allclose(energy.place(x**4 * (2 - x**4)), x, atol=1e-7)


def test_exact_reflectance_is_known_at_its_ends():
    eta, k = np.array([1.5, 1.0, 0.2]), np.array([0.0, 0.0, 3.0])
    head_on = energy.exact(eta, k, np.array([1.0]))[0]
    np.testing.assert_allclose(head_on[:2], [0.04, 0], atol=1e-15)
    assert head_on[2] == pytest.approx(((0.2 - 1) ** 2 + 9) / ((0.2 + 1) ** 2 + 9))
    np.testing.assert_allclose(energy.exact(eta, k, np.array([0.0]))[0, ::2], 1, atol=1e-9)
