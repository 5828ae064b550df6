"""The energy claim: the quadrature is right, the maskings do what the report says of them."""

import math

import numpy as np
import pytest

from reports.furnace import (
    MASKINGS,
    Surface,
    diffuse_albedo,
    energy_claim,
    facets,
    furnace_albedo,
    projected_area_beckmann,
    projected_area_ggx,
    weak_furnace,
)
from reports.html.energy_claim import energy_claim_view
from reports.stability.oracle import oracle
from scenes.schema import Material

ENDS = np.array([0, 0.3, 0.5, 1])
# The narrowest and widest lobes, and the widths between them for which the nodes err most.
HARD = [(alpha, angle) for alpha in (0.01, 0.04, 0.7, 1) for angle in (0, 60, 89)]


def masked(alpha, cosine):
    """G1 of the two lobes, Smith."""
    return cosine / projected_area_ggx(cosine, alpha), cosine / projected_area_beckmann(
        cosine, alpha
    )


@pytest.mark.parametrize(("alpha", "angle"), HARD)
@pytest.mark.parametrize("ndf", ["ggx", "beckmann"])
def test_projected_area_of_facets_is_smiths(ndf, alpha, angle):
    theta = math.radians(angle)
    f = facets(ndf, alpha, theta, lit=False)
    g1 = dict(zip(("ggx", "beckmann"), masked(alpha, math.cos(theta)), strict=True))[ndf]
    assert f.weight @ f.seen == pytest.approx(1 / g1, rel=1e-6)


@pytest.mark.parametrize(("alpha", "angle"), HARD)
def test_weak_furnace_of_the_papers_mixture_is_its_closed_form(alpha, angle):
    # The V-cavity covers any facets exactly, so only GGX's masking on Beckmann's facets errs.
    theta = math.radians(angle)
    ggx, beckmann = masked(alpha, math.cos(theta))
    w, v = ENDS, ENDS[::-1]
    for share, other in ((w, None), (w, v)):
        surface = Surface((alpha, alpha), share, "paper", other)
        expected = 1 + (1 - share) * (share if other is None else other) * (ggx / beckmann - 1)
        assert weak_furnace(surface, theta) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(("alpha", "angle"), HARD)
def test_exact_masking_neither_makes_nor_loses_light(alpha, angle):
    surface = Surface((alpha, alpha), ENDS, "smith")
    assert weak_furnace(surface, math.radians(angle)) == pytest.approx(1, abs=1e-6)


@pytest.mark.parametrize("masking", MASKINGS)
@pytest.mark.parametrize(("alpha", "angle"), HARD)
def test_furnace_albedo_has_converged(masking, alpha, angle):
    surface, theta = Surface((alpha, alpha), ENDS, masking), math.radians(angle)
    few, many = (furnace_albedo(surface, theta, (1, 0.04), nodes) for nodes in (24, 48))
    assert np.abs(few - many).max() < 1e-5
    assert diffuse_albedo(theta, 0.04) == pytest.approx(diffuse_albedo(theta, 0.04, 48), abs=1e-9)


@pytest.mark.parametrize("angle", [20, 60, 80])
def test_panels_end_at_the_cavitys_kinks(angle):
    # 12 nodes reach 1e-7 only if no panel has a kink inside.
    surface, theta = Surface((0.3, 0.3), np.zeros(1), "paper"), math.radians(angle)
    few, many = (furnace_albedo(surface, theta, nodes=nodes) for nodes in (12, 48))
    assert few == pytest.approx(many, abs=1e-7)


def test_furnace_albedo_of_the_roughest_ggx_head_on_is_its_closed_form():
    # G1 = 2 z / (1 + z) and D = 1 / π: A = ∫ z / (1 + z) dz over z = n.wi from 0 to 1.
    surface = Surface((1, 1), np.ones(1), "paper")
    assert furnace_albedo(surface, 0.0)[0, 0] == pytest.approx(1 - math.log(2), abs=1e-9)


@pytest.mark.parametrize("weight", [0.0, 0.5, 1.0])
def test_furnace_albedo_is_the_models_integral_over_light(weight):
    # Of the whole white surface, by a plain grid over light and the model as stability.py has it.
    material = Material(albedo=(1, 1, 1), f0=0.04, roughness=0.7, metallic=0, weight=weight)
    theta, steps = math.radians(70), 600
    polar = (np.arange(steps) + 0.5) / steps * np.pi / 2
    phi = (np.arange(steps) + 0.5) / steps * np.pi
    polar, phi = (a.ravel() for a in np.meshgrid(polar, phi))
    wi = np.stack([np.sin(polar) * np.cos(phi), np.sin(polar) * np.sin(phi), np.cos(polar)], 1)
    wo = np.broadcast_to([math.sin(theta), 0, math.cos(theta)], wi.shape)
    area = np.sin(polar) * np.cos(polar) * (np.pi / 2 / steps) * (2 * np.pi / steps)
    surface = Surface((material.alpha, material.alpha), np.array([weight]), "paper")
    ours = furnace_albedo(surface, theta, (0.04,))[0, 0] + diffuse_albedo(theta, 0.04)
    # 600 x 600 midpoints err by a few 1e-5 at the cavity's kinks.
    assert ours == pytest.approx(area @ oracle(material, wi, wo)[:, 0], abs=2e-4)


@pytest.mark.parametrize(
    ("widths", "angle", "figure"),
    [((0.04, 0.64), 80, 1.145), ((0.64, 0.04), 80, 0.855), ((0.01, 1), 89, 4.62)],
)
def test_lobes_of_different_width_make_and_lose_light(widths, angle, figure):
    surface = Surface(widths, np.array([0.5]), "paper")
    assert weak_furnace(surface, math.radians(angle))[0] == pytest.approx(figure, rel=1e-3)


def test_what_the_report_says_of_the_claim_is_so():
    claim = energy_claim()
    assert claim.most("weak", "paper").figure < 1 + 1e-6  # never makes light
    assert claim.least("weak", "paper").figure == pytest.approx(0.8929, abs=1e-4)
    assert claim.least("weak", "paper").weight == 0.5
    ends = claim.figures["weak", "paper"][..., [0, -1]]
    assert ends == pytest.approx(np.ones_like(ends), abs=1e-6)
    exact = claim.figures["weak", "smith"]
    assert exact == pytest.approx(np.ones_like(exact), abs=1e-6)
    for masking in MASKINGS:
        assert claim.most("albedo", masking).figure < 1 + 1e-6
        head_on = claim.figures["albedo", masking][-1, 0]
        assert head_on.max() < 0.5  # lost at every weight
        assert claim.figures["surface", masking][..., [0, -1]].max(axis=(0, 1)).min() > 1.4
        assert claim.most("shortcut", masking).figure < 1.01


def test_every_chart_is_a_named_picture_in_the_pages_colours():
    charts = [chart for row in energy_claim_view().charts for chart in row]
    assert len(charts) == 9
    for chart in charts:
        assert 'role="img"' in chart.svg and f"<title>{chart.title}</title>" in chart.svg
        assert "<desc>" in chart.svg and "var(--series1)" in chart.svg
        assert "#" not in chart.svg and "black" not in chart.svg  # would not follow the theme
        assert len(chart.svg) < 16_000


def test_charts_tell_their_numbers():
    weak = energy_claim_view().charts[0][0]
    assert weak.header[:2] == ["weight", "0.2, 80°, paper"]
    (half,) = (row for row in weak.rows if row[0] == "0.5")
    assert half[3] == "89.3 %" and half[-1] == "100.0 %"


def test_the_command_prints_the_worst_departures(shadeproof):
    code, out, _ = shadeproof("furnace")
    assert code == 0
    assert "0.8929: 1, 89°, 0.5" in out and "0.7586 to 4.6214" in out
