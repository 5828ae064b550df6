"""Facets with a direction: the shaders and Mitsuba beside double precision."""

import numpy as np
import pytest

from reference import probe as reference
from renderer import probe as renderer
from reports.run.stability.materials import beside_oracle
from reports.stability import anisotropic
from reports.stability.agreement import agreement
from reports.stability.oracle import brdf as isotropic
from scenes.schema import Material, Model

WIDTHS = [(0.3, 0.8), (0.7, 0.5), (1.0, -0.9), (0.2, 0.95)]  # roughness, anisotropy


def material(roughness, anisotropy, weight):
    fields = {"albedo": (0.6, 0.3, 0.05), "metallic": 0.5, "metal": "Cu", "weight": weight}
    return Material(roughness=roughness, anisotropy=anisotropy, **fields)


def directions(alpha, count=20_000):
    """Pairs above the surface, half of them mirrored about facets of such widths."""
    rng = np.random.default_rng(3)
    wo = rng.normal(size=(count, 3))
    slopes = rng.standard_t(3, size=(count, 2)) * alpha
    h = np.column_stack([slopes, np.ones(count)])
    wi = rng.normal(size=(count, 3))
    wo[:, 2], wi[:, 2] = np.abs(wo[:, 2]), np.abs(wi[:, 2])
    wo, wi, h = (w / np.linalg.norm(w, axis=1, keepdims=True) for w in (wo, wi, h))
    mirrored = 2 * (wo * h).sum(axis=1, keepdims=True) * h - wo
    wi[::2] = mirrored[::2]
    kept = (wi[:, 2] > 1e-4) & (wo[:, 2] > 1e-4)
    return wi[kept].astype(np.float32), wo[kept].astype(np.float32)


@pytest.mark.parametrize("masking", ["paper", "smith"])
@pytest.mark.parametrize("weight", [0.0, 0.4, 1.0])
@pytest.mark.parametrize(("roughness", "anisotropy"), WIDTHS)
def test_both_sides_are_the_formula(roughness, anisotropy, weight, masking):
    surface, model = material(roughness, anisotropy, weight), Model(masking=masking)
    wi, wo = directions(surface.alphas)
    truth = anisotropic.brdf(surface, wi, wo, model)
    for side in (renderer, reference):
        found = side.brdf_values(surface, wi, wo, model)
        assert agreement(surface, masking, "", found, truth, wi, wo).passed


@pytest.mark.parametrize("fresnel", ["f82", "exact"])
def test_every_fresnel_goes_with_a_direction(fresnel):
    surface, model = material(0.5, 0.7, 0.4), Model(fresnel=fresnel)
    wi, wo = directions(surface.alphas)
    truth = anisotropic.brdf(surface, wi, wo, model)
    for side in (renderer, reference):
        found = side.brdf_values(surface, wi, wo, model)
        assert agreement(surface, "paper", "", found, truth, wi, wo).passed


def test_the_formula_with_one_width_is_the_isotropic_one():
    surface = material(0.6, 0.0, 0.3)
    wi, wo = directions(surface.alphas)
    numbers = surface.diffuse_albedo, surface.specular_f0, surface.alpha, (0.3, 0.7), (0.3, 0.7)
    for masking in ("paper", "smith"):
        expected = isotropic(wi, wo, *numbers, masking)
        np.testing.assert_allclose(
            anisotropic.brdf(surface, wi, wo, Model(masking=masking)), expected, rtol=1e-9
        )


@pytest.mark.parametrize("anisotropy", [-1.0, 1.0])
@pytest.mark.parametrize("roughness", [0.0, 0.01, 0.5, 1.0])
def test_the_ends_of_the_scale_are_finite_and_agree(roughness, anisotropy):
    surface = material(roughness, anisotropy, 0.5)
    wi, wo = directions(surface.alphas)
    glsl, mitsuba = (side.brdf_values(surface, wi, wo) for side in (renderer, reference))
    assert np.isfinite(glsl).all() and (glsl >= 0).all()
    # A slope of 1e-4 is 1e3 roundings of a direction: per mille is all that float32 can tell.
    off = np.abs(glsl - mitsuba) / np.maximum(mitsuba, 1e-4 * mitsuba.max(axis=0))
    assert np.quantile(off, 0.99) < 5e-3


@pytest.mark.parametrize(("lobe", "D"), [("ggx", "D_ggx"), ("beckmann", "D_beckmann")])
@pytest.mark.parametrize("alpha", [(0.5, 0.05), (1.2, 0.3), (1e-4, 0.4)])
def test_samples_have_the_density_of_their_facets(lobe, D, alpha):
    """The mean of 1 / D over them is the solid angle that they span, where D is not small."""
    n = 1 << 16
    rng = np.random.default_rng(1)
    alphas = np.broadcast_to(np.float32(alpha), (n, 2))
    includes = ("ndf_ggx.glsl", "ndf_beckmann.glsl", "ndf_anisotropic.glsl")
    includes += ("sample_ggx.glsl", "sample_beckmann.glsl", "sample_anisotropic.glsl")
    given = {"u": rng.random((n, 2)), "a": alphas}
    h = renderer.probe(f"vec4(sample_{lobe}(u.xy, a.xy), 0.0)", given, includes)[:, :3]
    assert np.allclose(np.linalg.norm(h, axis=1), 1, atol=1e-6) and (h[:, 2] > 0).all()
    slopes = h[:, :2].astype(float) / h[:, 2:] / np.float32(alpha)
    # Slopes in units of alpha are those of isotropic facets of width 1: by azimuth and by tangent.
    tan2, phi = (slopes**2).sum(axis=1), np.arctan2(slopes[:, 1], slopes[:, 0])
    beyond = 1 / (1 + tan2) if lobe == "ggx" else np.exp(-tan2)
    for uniform in (beyond, phi / (2 * np.pi) + 0.5):
        counts = np.histogram(uniform, bins=32, range=(0, 1))[0]
        assert np.abs(counts / n * 32 - 1).max() < 0.12  # 5 sigma of 2,048 counts
    density = renderer.probe(f"vec4({D}(h.xyz, a.xy))", {"h": h, "a": alphas}, includes)[:, 0]
    exact = getattr(anisotropic, D)(h, np.float32(alpha).astype(float))
    np.testing.assert_allclose(density, exact, rtol=2e-3 if min(alpha) < 1e-3 else 1e-4)


def test_a_suite_checks_its_materials_as_they_are(monkeypatch):
    surface = material(0.5, 0.7, 0.4)
    assert beside_oracle(surface, Model()).passed
    turned = surface.model_copy(update={"anisotropy": -0.7})
    monkeypatch.setattr(anisotropic, "brdf", lambda _m, *rest, f=anisotropic.brdf: f(turned, *rest))
    assert not beside_oracle(surface, Model()).passed
