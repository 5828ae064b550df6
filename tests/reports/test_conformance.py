"""The definitions that the renderer's maps and tables are held against, and how the gate judges."""

from dataclasses import replace

import numpy as np
import pytest

from renderer import precompute
from renderer.techniques import technique
from reports import gate, parity
from reports.conformance.kernels import cumulated, lambert, reflected
from reports.conformance.light import Light
from reports.conformance.result import Conformance
from reports.conformance.split_sum import scale_bias, smith
from reports.conformance.textures import bilinear
from reports.run.conformance import conformance
from reports.run.conformance.geometry import of_edges
from reports.run.conformance.shading import of_split_sum
from reports.run.conformance.shared import ALLOWED
from reports.stability import oracle
from scenes.suite import expand, load_suite
from tests.reports.pages import results, row

AXES = np.array([[0, 0, 1.0], [0.6, 0, 0.8], [0, -1, 0]])


def test_irradiance_of_even_light_is_pi_and_of_a_lit_half_is_half():
    even = Light(np.ones((16, 32, 3)))
    (E,), (alone,), _ = even.convolved(AXES, [lambert])
    assert pytest.approx(np.pi, rel=1e-3) == E
    assert alone == pytest.approx(np.pi, rel=1e-3)
    half = np.ones((65, 128, 3))
    half[32:] = np.array([0.5, *[0] * 32])[:, None, None]  # row 32 is the horizon
    (E,), _, _ = Light(half).convolved(AXES, [lambert])
    assert E[0] == pytest.approx(np.pi, rel=2e-3)
    assert E[2] == pytest.approx(np.pi / 2, rel=2e-3)


@pytest.mark.parametrize("lobe", [oracle.D_ggx, oracle.D_beckmann])
def test_a_prefiltered_weight_is_the_mean_cosine_of_what_is_reflected(lobe):
    """For alpha that nears 0 all goes to the axis, where n.l is 1; the density integrates to 1."""
    _, (narrow,), _ = Light(np.ones((512, 1024, 3))).convolved(AXES, [reflected(lobe, 0.04)])
    assert narrow == pytest.approx(1, abs=0.02)


def test_bilinear_wraps_columns_and_clamps_rows():
    texels = np.arange(8.0).reshape(2, 4, 1)
    uv = np.array([[0.0, 0.0], [0.125, 0.25], [1.0, 1.0], [-0.875, 0.5]])
    assert bilinear(texels, uv)[:, 0] == pytest.approx([1.5, 0, 5.5, 2])


@pytest.mark.parametrize("lobe", ["ggx", "beckmann", "cosine"])
def test_the_share_of_samples_is_the_integral_of_their_density(lobe):
    alpha = 0.4
    theta = np.linspace(0, 1.2, 20_001)
    h = np.stack([np.sin(theta), 0 * theta, np.cos(theta)], 1)
    density = np.cos(theta) / np.pi
    if lobe != "cosine":
        density = getattr(oracle, f"D_{lobe}")(h, alpha) * np.cos(theta)
    integral = np.trapezoid(density * 2 * np.pi * np.sin(theta), theta)
    assert cumulated(lobe, np.cos(1.2), alpha) == pytest.approx(integral, abs=1e-6)


def test_scale_and_bias_are_the_albedo_of_the_brdf():
    """With F0 = 1 they sum to the share of even light that is reflected."""
    alpha, cosine, weight = 0.3, 0.6, (0.3, 0.7)
    made = scale_bias(cosine, alpha, weight, smith(alpha, weight))
    z, phi = np.meshgrid((np.arange(800) + 0.5) / 800, 2 * np.pi * (np.arange(800) + 0.5) / 800)
    z, phi = z.ravel(), phi.ravel()
    s = np.sqrt(1 - z**2)
    wi = np.stack([s * np.cos(phi), s * np.sin(phi), z], 1)
    wo = np.broadcast_to([np.sqrt(1 - cosine**2), 0, cosine], wi.shape)
    f = oracle.brdf(wi, wo, np.zeros(3), np.ones(3), alpha, weight, weight, "smith")[:, 0]
    assert made.sum() == pytest.approx((f * z).mean() * 2 * np.pi, rel=1e-3)


def test_the_renderer_conforms_on_the_suite_guard():
    entries = [
        e.model_copy(update={"techniques": (*e.techniques, "split", "filtered")})
        for e in expand(*load_suite("guard"))
    ]
    found = conformance(entries)
    assert {f.name for f in found} == set(ALLOWED)
    assert all(f.passed for f in found), found


def test_maps_of_an_environment_that_is_no_longer_kept_are_made_again():
    case = expand(*load_suite("guard"))[0].case
    precompute._cached.cache_clear()  # as more environments than it holds would do
    obj = case.judged[0]
    assert of_split_sum(case.environment, obj.material, case.model, technique("paper")).passed


def test_nan_is_no_conformance():
    assert not Conformance("light", float("nan"), 1.0, "").passed


@pytest.mark.parametrize("judged", [True, False])
def test_the_gate_fails_on_a_check_that_fails_unless_it_is_only_told(judged):
    made = parity.Checks(judged=judged, definitions=[Conformance("tables", 0.5, 0.01, "here")])
    run = results([row(verdict="pass")], provenance={"parity": made.verdicts()}, missing=[])
    run = gate.conclude(run)
    assert run.verdict == ("fail" if judged else "pass")
    assert ("tables" in "; ".join(run.reasons)) == judged


@pytest.mark.parametrize(("msaa", "passed"), [(4, True), (0, False)])
@pytest.mark.parametrize("name", ["paper", "sampled@64"])
@pytest.mark.parametrize("number", [0, 2, 3])
def test_edges_tell_a_box_filter_from_none(monkeypatch, name, number, msaa, passed):
    case = expand(*load_suite("guard"))[number].case
    how = replace(technique(name), msaa=msaa)
    monkeypatch.setattr("reports.run.conformance.geometry.technique", lambda _name: how)
    assert of_edges(case, name).passed == passed


@pytest.mark.parametrize(("name", "told"), [("best", True), ("best-without-antialiasing", False)])
def test_edges_are_those_against_the_sky_and_of_who_filters(name, told):
    found = of_edges(expand(*load_suite("guard"))[0].case, name)
    assert found.passed if told else found is None


def test_the_masks_of_a_small_object_may_differ_by_ties():
    made = parity.Checks()
    made.silhouettes = [(0.9, 2.0, "a dot")]
    assert made.verdicts()[0]["passed"]
    made.silhouettes.append((0.97, 300.0, "a ball"))
    assert not made.verdicts()[0]["passed"]
