"""The oracle does not cancel: beside 80-bit arithmetic, by other formulas where there are some."""

import numpy as np
import pytest

from reports.stability import oracle
from reports.stability.grid import ALPHAS, COSINES, pairs, unit

L = np.longdouble
PI = L("3.14159265358979323846264338327950288")
REST = 1e-13  # float64 has 16 digits; t of Beckmann's exp(-t) magnifies the last of them


@pytest.fixture(scope="module")
def some():
    """Three hundred of the atlas' pairs, from every cell."""
    alpha, wi, wo = pairs(per_cell=8)
    kept = np.random.default_rng(5).permutation(len(alpha))[:300]
    return alpha[kept].astype(float), wi[kept].astype(float), wo[kept].astype(float)


def apart(ours, theirs) -> float:
    """Relative, where that matters: above 1e-30 of the largest."""
    theirs = np.asarray(theirs, L)
    return float(np.max(np.abs(ours - theirs) / np.maximum(np.abs(theirs), 1e-30)))


def half(wi, wo):
    both = wi.astype(L) + wo.astype(L)
    wi_h = np.sqrt((both**2).sum(axis=1)) / 2
    return both / (2 * wi_h[:, None]), wi_h


def lambda_beckmann(a):
    """Heitz 2014, eq. 68, as the integral that it solves: ∫ (x - a) exp(-x²) dx / (a √π) from a."""
    nodes, weights = np.polynomial.legendre.leggauss(120)
    # x = a + s; beyond 12 nothing is left.
    s, ds = (nodes.astype(L) + 1) * 6, weights.astype(L) * 6
    x = a[:, None] + s
    return (s * np.exp(-(x**2)) * ds).sum(axis=1) / (a * np.sqrt(PI))


def test_half_vectors_are_those_of_longer_arithmetic(some):
    _, wi, wo = some
    h, wi_h = oracle.half_vector(wi, wo)
    exact, exact_cosine = half(wi, wo)
    assert np.abs(h - exact).max() < 1e-15 and apart(wi_h, exact_cosine) < REST


def test_ndfs_are_those_of_longer_arithmetic(some):
    alpha, wi, wo = some
    h, _ = half(wi, wo)
    a2, z2 = alpha.astype(L) ** 2, h[:, 2] ** 2
    t = (h[:, 0] ** 2 + h[:, 1] ** 2) / z2 / a2
    ggx, beckmann = 1 / (PI * a2 * z2**2 * (1 + t) ** 2), np.exp(-t) / (PI * a2 * z2**2)
    ours, _ = oracle.half_vector(wi, wo)
    assert apart(oracle.D_ggx(ours, alpha), ggx) < REST
    counts = t < 60  # exp(-60) is 1e-26
    found = oracle.D_beckmann(ours, alpha)
    assert apart(found[counts], beckmann[counts]) < 60 * REST
    assert (found[~counts] < 1e-15).all()


def test_maskings_are_those_of_longer_arithmetic():
    alpha, cosine = (v.ravel() for v in np.meshgrid(ALPHAS, COSINES))
    w = unit(cosine, 0.3 + 0 * cosine).astype(np.float32).astype(float)
    x, y, z = w.astype(L).T
    tangent = np.sqrt(x * x + y * y) / z
    ggx = (1 + np.sqrt(1 + (alpha.astype(L) * tangent) ** 2)) / 2
    a = 1 / np.maximum(alpha.astype(L) * tangent, L(1e-9))
    beckmann = 1 + lambda_beckmann(a)
    assert apart(1 / oracle.G1_smith(w, alpha, (1, 0)), ggx) < REST
    # The integral's nodes are good to 1e-12 where the lobe ends within a small part of their range.
    assert apart(1 / oracle.G1_smith(w, alpha, (0, 1)), beckmann) < 1e-9
    mixed = ggx * L(0.25) + beckmann * L(0.75)
    assert apart(1 / oracle.G1_smith(w, alpha, (0.25, 0.75)), mixed) < 1e-9


@pytest.mark.parametrize("masking", ["paper", "smith"])
def test_the_whole_is_that_of_longer_arithmetic(some, masking):
    alpha, wi, wo = some
    h, wi_h = half(wi, wo)
    zi, zo, zh = (v[:, 2].astype(L) for v in (wi, wo, h))
    a2 = alpha.astype(L) ** 2
    t = (h[:, 0] ** 2 + h[:, 1] ** 2) / zh**2 / a2
    D = (L(0.25) / (1 + t) ** 2 + L(0.75) * np.exp(-t)) / (PI * a2 * zh**4)
    tangents = [
        np.sqrt(w[:, 0].astype(L) ** 2 + w[:, 1].astype(L) ** 2) / w[:, 2] for w in (wi, wo)
    ]
    ggx = [(1 + np.sqrt(1 + a2 * tan**2)) / 2 for tan in tangents]
    if masking == "paper":
        cavity = np.minimum(1, 2 * zh * np.minimum(zi, zo) / wi_h)
        G = L(0.25) / (ggx[0] * ggx[1]) + L(0.75) * cavity
    else:
        a = [1 / np.maximum(alpha * tan, L(1e-9)) for tan in tangents]
        mixed = [
            L(0.25) * g + L(0.75) * (1 + lambda_beckmann(x)) for g, x in zip(ggx, a, strict=True)
        ]
        G = 1 / (mixed[0] * mixed[1])
    F = L(0.5) + L(0.5) * (1 - np.minimum(wi_h, 1)) ** 5
    expected = (1 - F) * L(0.25) / PI + F * D * G / (4 * zi * zo)
    surface = ([0.25] * 3, [0.5] * 3, alpha, (0.25, 0.75), (0.25, 0.75), masking)
    found = oracle.brdf(wi, wo, *map(np.asarray, surface[:2]), *surface[2:])[:, 0]
    assert apart(found, expected) < 1e-9  # as far as the integral for Beckmann's Lambda is known


def test_what_is_not_reflected_does_not_cancel_either(some):
    _, wi, wo = some
    wi_h = oracle.half_vector(wi, wo)[1]
    _, exact = half(wi, wo)
    kd = 1 - oracle.F_schlick(np.full(3, 0.04), wi_h)[:, 0]
    theirs = L(0.96) * (1 - (1 - np.minimum(exact, 1)) ** 5)
    # 1 - F of float64 keeps 16 digits of 1, and h.wi is 1e-6 at the least.
    assert apart(kd, theirs) < 1e-9


def test_directions_are_drawn_where_the_ndf_has_its_share():
    # The share of facets within a tilt is u itself: sin² / (sin² + a² cos²), 1 - exp(-tan²/a²).
    u = np.stack([np.linspace(0.001, 0.999, 99), np.linspace(0, 1, 99)], axis=1)
    for alpha in (1e-4, 0.1, 1.0):
        tan2 = [
            (h[:, 0] ** 2 + h[:, 1] ** 2) / h[:, 2] ** 2 / alpha**2
            for h in (oracle.sampled_ggx(u, alpha), oracle.sampled_beckmann(u, alpha))
        ]
        np.testing.assert_allclose(tan2[0] / (1 + tan2[0]), u[:, 0], rtol=1e-9)
        np.testing.assert_allclose(-np.expm1(-tan2[1]), u[:, 0], rtol=1e-9)
