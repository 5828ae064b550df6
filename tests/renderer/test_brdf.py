"""The GLSL functions themselves, per direction, against double precision."""

import numpy as np
import pytest
from scipy.special import erf

from renderer.probe import brdf_values, probe
from reports.stability.agreement import FLOOR, TOLERANCE
from reports.stability.directions import directions, materials
from scenes.schema import PAPER, Model

SMITH = Model(masking="smith")
ALPHAS = (0.01, 0.05, 0.16, 0.49, 1.0)
ALL_LOBES = frozenset({"D_GGX", "D_BECKMANN", "G_GGX", "G_BECKMANN"})


def worst(ours: np.ndarray, theirs: np.ndarray) -> float:
    """Largest |difference| over max(|f|, 1e-4 of the peak)."""
    return np.max(np.abs(ours - theirs) / np.maximum(np.abs(theirs), FLOOR * np.abs(theirs).max()))


def halves(alpha: float) -> np.ndarray:
    """20,000 float32 half vectors, from within a hundredth of alpha to the horizon."""
    rng = np.random.default_rng(1)
    theta = np.arctan(alpha * 10 ** rng.uniform(-2, 2.5, 20_000))
    phi = rng.uniform(0, 2 * np.pi, 20_000)
    h = [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]
    return np.stack(h, axis=1).astype(np.float32)


@pytest.mark.parametrize("alpha", ALPHAS)
@pytest.mark.parametrize("lobe", ["ggx", "beckmann"])
def test_ndf_is_that_of_walter_2007(lobe, alpha):
    h = halves(alpha)
    ours = probe(f"vec4(D_{lobe}(h.xyz, {alpha}))", {"h": h}, (f"ndf_{lobe}.glsl",))[:, 0]
    h = h.astype(float)
    cos2, tan2 = h[:, 2] ** 2, (h[:, 0] ** 2 + h[:, 1] ** 2) / h[:, 2] ** 2
    if lobe == "ggx":
        theirs = alpha**2 / (np.pi * cos2**2 * (alpha**2 + tan2) ** 2)
    else:
        theirs = np.exp(-tan2 / alpha**2) / (np.pi * alpha**2 * cos2**2)
    assert worst(ours, theirs) <= TOLERANCE


@pytest.mark.parametrize("alpha", ALPHAS)
@pytest.mark.parametrize("lobe", ["ggx", "beckmann"])
def test_ndf_projects_to_the_area_of_its_plane(lobe, alpha, half_vectors):
    h, omega = half_vectors(alpha, 256, 1)
    D = probe(f"vec4(D_{lobe}(h.xyz, {alpha}))", {"h": h}, (f"ndf_{lobe}.glsl",))[:, 0]
    # 256 Gauss nodes integrate both to 1e-9; what remains is float32.
    assert (D * h[:, 2] * omega).sum() == pytest.approx(1, abs=2e-5)


@pytest.mark.parametrize("lobe", ["ggx", "beckmann"])
def test_ndf_is_nothing_below_the_surface(lobe):
    h = np.array([[0, 0, -1], [1, 0, 0], [0.6, 0, -0.8], [1, 0, 1e-9]])
    D = probe(f"vec4(D_{lobe}(h.xyz, 0.3))", {"h": h}, (f"ndf_{lobe}.glsl",))[:, 0]
    assert (D[[0, 2]] == 0).all() and np.isfinite(D).all() and (D >= 0).all()


@pytest.mark.parametrize("alpha", ALPHAS)
def test_masking_is_that_of_its_authors(alpha):
    wi, wo = directions(alpha)
    both = wi.astype(float) + wo
    wo_h = np.linalg.norm(both, axis=1) / 2
    h = both / (2 * wo_h[:, None])
    smith = probe(
        f"vec4(G_smith(wi.xyz, wo.xyz, {alpha}))", {"wi": wi, "wo": wo}, ("masking_smith.glsl",)
    )[:, 0]
    cavity = probe(
        "vec4(G_vcavity(wi.xyz, wo.xyz, h.xyz, h.w))",
        {"wi": wi, "wo": wo, "h": np.column_stack([h, wo_h])},
        ("masking_vcavity.glsl",),
    )[:, 0]

    def G1(cosine):
        return 2 / (1 + np.sqrt(1 + alpha**2 * (1 - cosine**2) / cosine**2))

    cos_i, cos_o = wi[:, 2].astype(float), wo[:, 2].astype(float)
    assert worst(smith, G1(cos_i) * G1(cos_o)) <= TOLERANCE
    facing = np.minimum(1, 2 * h[:, 2] * np.minimum(cos_i, cos_o) / wo_h)
    assert worst(cavity, facing) <= TOLERANCE


@pytest.mark.parametrize(
    ("name", "call"),
    [("smith", "G_smith(wi.xyz, z, 0.3)"), ("vcavity", "G_vcavity(wi.xyz, z, z, 0.5)")],
)
def test_masking_is_nothing_from_below(name, call):
    below = np.array([[0.6, 0, -0.8], [1.0, 0, 0]])
    z = "const vec3 z = vec3(0.0, 0.0, 1.0);"
    G = probe(f"vec4({call})", {"wi": below}, (f"masking_{name}.glsl",), declarations=z)
    assert (G == 0).all()


@pytest.mark.parametrize("alpha", ALPHAS)
def test_smiths_lambda_of_beckmann_has_an_exact_erf(alpha):
    a = 10 ** np.linspace(-4, 2, 20_000)
    tangent = (1 / (alpha * a)).astype(np.float32)
    a = 1 / (np.float64(np.float32(alpha)) * tangent)
    exact = (erf(a) - 1) / 2 + np.exp(-(a**2)) / (2 * a * np.sqrt(np.pi))
    call = f"vec4(lambda_beckmann(t.x, {alpha}))"
    found = probe(call, {"t": tangent}, ("masking_smith_mixture.glsl",))[:, 0]
    # 7e-8 from the polynomial; the rest is float32 and a driver's exp.
    assert np.max(np.abs(found - exact) / (1 + exact)) < 3e-6


def test_fresnel_is_schlick_from_head_on_to_grazing():
    cosine = np.concatenate([np.linspace(0, 1, 5000), [-1e-6, 1 + 1e-6]]).astype(np.float32)
    ours = probe(
        "vec4(F_schlick(vec3(0.0, 0.04, 1.0), c.x), 0.0)", {"c": cosine}, ("fresnel_schlick.glsl",)
    )[:, :3]
    f0 = np.array([0, 0.04, 1])
    theirs = f0 + (1 - f0) * (1 - np.clip(cosine.astype(float), 0, 1))[:, None] ** 5
    assert worst(ours, theirs) <= TOLERANCE
    assert ours.max() <= 1


@pytest.mark.parametrize("model", [PAPER, SMITH], ids=lambda m: m.masking)
@pytest.mark.parametrize("material", materials()[1::3], ids=lambda m: f"a={m.alpha:.2g}")
def test_brdf_is_reciprocal(material, model):
    wi, wo = directions(material.alpha)
    forth, back = brdf_values(material, wi, wo, model), brdf_values(material, wo, wi, model)
    assert worst(forth, back) <= 1e-6  # the same sums in another order


@pytest.mark.parametrize("model", [PAPER, SMITH], ids=lambda m: m.masking)
def test_brdf_is_nothing_from_below(model):
    material = materials()[5]
    up, down = np.array([[0.6, 0, 0.8]] * 3), np.array([[0, 0, -1], [1, 0, 0], [0, 0.8, -0.6]])
    assert (brdf_values(material, up, down, model) == 0).all()
    assert (brdf_values(material, down, up, model) == 0).all()


@pytest.mark.parametrize("weight", [0.0, 1.0])
def test_a_lobe_without_weight_changes_nothing(weight, copper):
    material = copper(0.2, weight)
    wi, wo = directions(0.2)
    both = probe(
        "vec4(brdf(wi.xyz, wo.xyz, Material(vec3(0.0), f0, alpha, w, w)), 0.0)",
        {"wi": wi, "wo": wo},
        ("brdf.glsl",),
        ALL_LOBES,
        {"f0": material.specular_f0, "alpha": material.alpha, "w": (weight, 1 - weight)},
        "uniform vec3 f0; uniform float alpha; uniform vec2 w;",
    )[:, :3]
    np.testing.assert_array_equal(brdf_values(material, wi, wo), both)


def test_every_input_of_a_probe_keeps_its_row():
    rows = np.arange(3000 * 4).reshape(3000, 4)
    expected = rows + rows[:, :1] * [1, 0, 0, 0]
    np.testing.assert_array_equal(probe("a + b", {"a": rows, "b": rows[:, :1]}, ()), expected)
