"""Random surfaces and directions, drawn by hypothesis: the shaders agree and stay finite."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps

from reports.run.stability.sides import exact, shader
from reports.stability.agreement import FLOOR, TOLERANCE
from reports.stability.functions import Inputs
from reports.stability.grid import unit

ROWS = 32
unit_floats = st.floats(0, 1, width=32)
rows = nps.arrays(np.float32, (ROWS, 5), elements=unit_floats, fill=unit_floats)
colours = st.tuples(unit_floats, unit_floats, unit_floats)
# At F0 = 0 the lobe has no light near n to measure by; the hard input `f0-at-its-ends` has it.
reflectances = st.tuples(*[st.floats(0.02, 1)] * 3)
shares = st.one_of(unit_floats, st.sampled_from([0.0, 1e-7, 1 - 1e-7, 1.0]))
once = settings(
    max_examples=60,
    deadline=None,  # a driver compiles each pair of weights anew
    suppress_health_check=[HealthCheck.data_too_large, HealthCheck.too_slow],
)


def inputs(drawn: np.ndarray, alpha_from: float, cosine_from: float) -> Inputs:
    """alpha, n.v and n.l from two smallest values to 1, by their logarithms."""
    alpha = alpha_from ** drawn[:, 0].astype(float)
    cosines = cosine_from ** drawn[:, 1:3].astype(float)
    wo = unit(cosines[:, 0], 2 * np.pi * drawn[:, 3])
    wi = unit(cosines[:, 1], 2 * np.pi * drawn[:, 4])
    return {"alpha": alpha.astype(np.float32), "wi": np.float32(wi), "wo": np.float32(wo)}


surfaces = st.tuples(
    rows, shares, shares, colours, reflectances, st.sampled_from(["paper", "smith"])
)


def keeps_its_promises(drawn, weight, weight_g, albedo, f0, masking):
    """The BRDF agrees with float64, and is finite and reciprocal."""
    surface = {"albedo": albedo, "f0": f0}
    surface |= {"weight": (weight, 1 - weight), "weight_g": (weight_g, 1 - weight_g)}
    pairs = inputs(drawn, 1e-4, 1e-6) | surface
    ours, truth = shader("brdf", pairs, masking), exact("brdf", pairs, masking)
    assert np.isfinite(ours).all() and (ours >= 0).all()
    # The peak seen from wo is at least f at h = n.
    mirrored = exact("brdf", pairs | {"wi": pairs["wo"] * np.float32([-1, -1, 1])}, masking)
    scale = np.maximum(truth, FLOOR * mirrored)
    assert (np.abs(ours - truth) <= TOLERANCE * scale + 1e-37).all()
    back = shader("brdf", pairs | {"wi": pairs["wo"], "wo": pairs["wi"]}, masking)
    assert (np.abs(back - ours) <= 1e-6 * ours + 1e-37).all()


@once
@given(surfaces)
def test_the_brdf_agrees_with_float64_and_is_finite_and_reciprocal(surface):
    keeps_its_promises(*surface)


@pytest.mark.long
@settings(once, max_examples=5000)
@given(surfaces)
def test_the_brdf_does_so_on_160000_pairs(surface):
    keeps_its_promises(*surface)


@once
@given(nps.arrays(np.float32, (ROWS, 6), elements=st.floats(-1, 1, width=32)), shares)
def test_any_vectors_at_all_give_light_that_is_finite_and_not_negative(drawn, weight):
    given_ = {"wi": drawn[:, :3], "wo": drawn[:, 3:], "alpha": np.float32(1e-4)}
    surface = {"albedo": (1, 1, 1), "f0": (0.04, 0.5, 1)}
    surface |= {"weight": (weight, 1 - weight), "weight_g": (weight, 1 - weight)}
    for masking in ("paper", "smith"):
        f = shader("brdf", given_ | surface, masking)
        assert np.isfinite(f).all() and (f >= 0).all()


@once
@given(nps.arrays(np.float32, (ROWS, 3), elements=unit_floats))
def test_random_numbers_give_directions_above_the_surface(drawn):
    u, alpha = drawn[:, :2], (1e-4 ** drawn[:, 2].astype(float)).astype(np.float32)
    for lobe in ("ggx", "beckmann", "cosine"):
        w = shader(f"sample_{lobe}", {"u": u, "alpha": alpha}).astype(float)
        assert (w[:, 2] >= 0).all()
        np.testing.assert_allclose(np.linalg.norm(w, axis=1), 1, atol=1e-6)


@once
@given(nps.arrays(np.float32, (ROWS, 3), elements=st.floats(-1, 1, width=32)))
def test_any_direction_finds_its_place_on_the_map(drawn):
    length = np.linalg.norm(drawn.astype(float), axis=1, keepdims=True)
    w = np.where(length > 1e-3, drawn / np.maximum(length, 1e-3), [0, 0, 1]).astype(np.float32)
    found, truth = (
        shader("latlong_from_direction", {"w": w}),
        exact("latlong_from_direction", {"w": w}),
    )
    assert np.isfinite(found).all()
    assert np.abs(found[:, 1] - truth[:, 1]).max() < 4e-6
