"""Every invariant of the shaders can fail: a fault put into the GLSL for each."""

import numpy as np
import pytest

from renderer.precompute import lost_light
from renderer.program import program
from reports.run.stability import NAMED, furnaces, geometry, lookups, models, terms
from reports.run.stability.brdf import Sweep, stock_maps


def failed(maps) -> set[str]:
    """What fails of some maps."""
    return {f"{m.function} {m.invariant}" for m in maps if not m.passed}


BRDF = [
    ("brdf.glsl", "F * (D * G /", "F * (1.0002 * D * G /", "against float64"),
    ("brdf.glsl", "0.5 * length(wi + wo)", "dot(wo, normalize(wi + wo))", "against Mitsuba"),
    ("ndf_beckmann.glsl", "exp(-dot", "exp(dot", "finite"),
    ("brdf.glsl", "f += one", "f -= one", "non-negative"),
    ("brdf.glsl", "F = fresnel(m, wo_h)", "F = fresnel(m, wo.z)", "reciprocal"),
    ("mixture.glsl", "G += weight.y * G_vcavity", "G += G_vcavity", "smooth in weight"),
    ("ndf_ggx.glsl", "INV_PI /", "(alpha > 0.1 ? 1.1 : 1.0) * INV_PI /", "smooth in roughness"),
]


@pytest.mark.parametrize(("file", "right", "wrong", "seen"), BRDF, ids=[b[3] for b in BRDF])
def test_a_fault_in_the_brdf_is_seen(broken, file, right, wrong, seen):
    broken(file, right, wrong)
    assert f"brdf {seen}" in failed(Sweep("paper").maps())


def test_a_wrong_power_is_seen_by_mitsubas_own_plugin_too(broken):
    broken("masking_smith_mixture.glsl", "sqrt(1.0 + x * x) - 1.0", "sqrt(1.0 + x) - 1.0")
    assert "brdf against roughconductor, GGX" in failed(stock_maps())


def test_a_wrong_jacobian_is_seen_in_the_density(broken):
    broken("density.glsl", "(4.0 * wo_h)", "(2.0 * wo_h)")
    assert "sample_density pdf against Mitsuba" in failed(stock_maps())


TERMS = [
    ("ndf_ggx.glsl", "+ h.z * h.z", "+ 1.0", "D_ggx"),
    ("ndf_beckmann.glsl", "z2 * z2", "z2", "D_beckmann"),
    ("mixture.glsl", "weight.y * D_beckmann", "weight.x * D_beckmann", "D_mixture"),
    ("beckmann_over_ggx.glsl", "(1.0 + t) * (1.0 + t)", "(1.0 + t)", "beckmann_over_ggx"),
    ("masking_smith.glsl", "alpha * alpha * tan2", "alpha * tan2", "G1_ggx"),
    ("masking_smith.glsl", "* G1_ggx(wo, alpha)", "", "G_smith"),
    ("masking_smith_mixture.glsl", "0.5 * (sqrt", "(sqrt", "lambda_ggx"),
    ("masking_smith_mixture.glsl", "1.061405429", "1.06", "lambda_beckmann"),
    ("masking_smith_mixture.glsl", "weight.x * lambda_ggx", "lambda_ggx", "G1_smith_mixture"),
    ("masking_vcavity.glsl", "2.0 * h.z", "h.z", "G_vcavity"),
    ("mixture.glsl", "weight.x * G_smith", "weight.y * G_smith", "G_mixture"),
    ("fresnel_schlick.glsl", "m2 * m2 * m", "m2 * m2", "F_schlick"),
    ("density.glsl", "wi.z * INV_PI", "wi.z", "sample_density"),
    ("sample_ggx.glsl", "alpha * alpha * u.x", "alpha * u.x", "sample_ggx"),
    ("sample_beckmann.glsl", "-log(max", "-0.999 * log(max", "sample_beckmann"),
    ("sample_cosine.glsl", "sqrt(1.0 - u.x)", "1.0 - u.x", "sample_cosine"),
]


@pytest.mark.parametrize(("file", "right", "wrong", "seen"), TERMS, ids=[t[3] for t in TERMS])
def test_a_fault_in_a_term_is_seen(broken, file, right, wrong, seen):
    broken(file, right, wrong)
    parts = {
        "ndf": terms.ndfs,
        "beckmann": terms.ndfs,
        "masking": terms.maskings,
        "fresnel": lambda: [terms.fresnel()],
        "density": lambda: [terms.density()],
        "sample": terms.samplers,
        "mixture": lambda: [*terms.ndfs(), *terms.maskings()],
    }
    start = file.removesuffix(".glsl").split("_")[0]
    assert f"{seen} against float64" in failed(parts[start]())


FRESNEL = [
    ("fresnel_f82.glsl", "M82 = 6.0 / 7.0", "M82 = 5.9 / 7.0", "F_f82"),
    ("fresnel_f82.glsl", "cos_theta) + drop_f82", "cos_theta) - drop_f82", "one_minus_F_f82"),
    ("fresnel_dielectric.glsl", "w * c - s2", "w * c + s2", "F_dielectric"),
    ("fresnel_dielectric.glsl", "eta2 / (p * p)", "1.0 / (p * p)", "one_minus_F_dielectric"),
    (
        "fresnel_dielectric.glsl",
        "(eta - 1.0) * (eta + 1.0), 0.0",
        "eta * eta - 1.0, 0.0",
        "F_dielectric",
    ),
    ("fresnel_conductor.glsl", "2.0 * eta * k)", "eta * k)", "F_conductor"),
    (
        "fresnel_conductor.glsl",
        "dot(n2, w) / dot(p, p)",
        "w.x / dot(p, p)",
        "one_minus_F_conductor",
    ),
]


@pytest.mark.parametrize(("file", "right", "wrong", "seen"), FRESNEL)
def test_a_fault_in_the_fresnel_of_a_model_is_seen(broken, file, right, wrong, seen):
    assert not failed(terms.fresnel_of_models())
    broken(file, right, wrong)
    assert f"{seen} against float64" in failed(terms.fresnel_of_models())


COMPENSATED = models.MODELS["the same, masking smith"]
MODELS = [
    ("brdf.glsl", "m.multiscatter * (lost.a", "m.multiscatter * (1.01 * lost.a", COMPENSATED),
    ("brdf.glsl", "lost.rgb * m.albedo", "lost.bgr * m.albedo", COMPENSATED),
    ("brdf.glsl", "dot(lost.xy, m.weight_d)", "lost.x", models.PHYSICAL),
    ("fresnel.glsl", "F += (1.0 - m.metallic)", "F += m.metallic", models.MODELS["exact"]),
    ("fresnel.glsl", "m.f0, m.f82, cos", "m.f0, m.f0, cos", models.MODELS["f82"]),
    ("directional_loss.frag", "0.5 / float(points)", "0.5", COMPENSATED),
    ("interface.frag", "/ G1_ggx(wo, alpha);", ";", models.PHYSICAL),
]


@pytest.fixture
def made_anew():
    """No map of losses is kept from shaders that were right, nor from broken ones."""
    cached = (lost_light._lost_light, lost_light._integrated, program)
    for kept in cached:
        kept.cache_clear()
    yield
    for kept in cached:
        kept.cache_clear()


@pytest.mark.parametrize(("file", "right", "wrong", "model"), MODELS)
def test_a_fault_in_a_model_is_seen(broken, made_anew, file, right, wrong, model):
    broken(file, right, wrong)
    found = failed(models.agreements("it", model, np.array([0.5])))
    assert {"model it, against float64", "model it, against Mitsuba"} & found


def test_what_one_side_alone_would_send_back_is_not_reciprocal(broken, made_anew):
    broken("brdf.glsl", "lost_light_at(wi.z) * lost_light_at(wo.z)", "lost_light_at(wi.z)")
    found = failed(models.agreements("it", COMPENSATED, np.array([0.5])))
    assert "model it, reciprocal" in found


def test_light_that_facets_do_not_give_back_is_seen(broken, made_anew):
    assert models.white_furnace(np.array([0.5])).passed
    broken("brdf.glsl", "m.multiscatter * (lost.a", "m.multiscatter * (0.9 * lost.a")
    assert not models.white_furnace(np.array([0.5])).passed


FURNACES = [
    ("ndf_beckmann.glsl", "INV_PI /", "0.999 * INV_PI /", "D_mixture normalised"),
    (
        "masking_smith_mixture.glsl",
        "return 1.0 / (1.0 + lambda)",
        "return 1.0 / (1.0 + 0.99 * lambda)",
        "G_mixture weak white furnace",
    ),
    ("brdf.glsl", "/ (4.0 *", "/ (3.9 *", "brdf white furnace"),
]


@pytest.mark.parametrize(("file", "right", "wrong", "seen"), FURNACES, ids=[f[3] for f in FURNACES])
def test_light_made_or_lost_is_seen(broken, file, right, wrong, seen):
    broken(file, right, wrong)
    assert seen in failed(furnaces.maps(np.array([0.01, 0.1]), np.array([0.1, 0.5])))


SURROUNDINGS = [
    ("frame.glsl", "n.z >= 0.0 ? 1.0 : -1.0", "1.0", geometry.tangent_frame),
    ("latlong.glsl", "length(world.xy), world.z", "world.z, length(world.xy)", geometry.latlong),
    ("hammersley.glsl", "0x0F0F0F0Fu", "0x0F0F0F0Eu", terms.hammersley),
    ("radiance.glsl", "max(size.y - 1.0, 1.0)", "(size.y - 1.0)", lookups.radiance_lod),
]


@pytest.mark.parametrize(
    ("file", "right", "wrong", "measured"), SURROUNDINGS, ids=[s[0] for s in SURROUNDINGS]
)
def test_a_fault_around_the_brdf_is_seen(broken, file, right, wrong, measured):
    assert measured().passed
    broken(file, right, wrong)
    assert not measured().passed


CLAMPED = "clamp(1.0 - cos_theta, 0.0, 1.0)"
NAMED_FAULTS = {
    "narrowest-lobe": ("ndf_ggx.glsl", "dot(h.xy, h.xy)", "(1.0 - h.z * h.z)"),
    "both-graze": ("brdf.glsl", "0.5 * length(wi + wo)", "dot(wo, normalize(wi + wo))"),
    "below-the-surface": ("brdf.glsl", "if (min(wi.z, wo.z) < HORIZON)", "if (false)"),
    "almost-below": ("brdf.glsl", "HORIZON = 1e-9", "HORIZON = 0.0"),
    "opposite": ("brdf.glsl", "if (min(wi.z, wo.z) < HORIZON)", "if (false)"),
    "nearly-opposite": ("brdf.glsl", "one_minus_fresnel(m, wo_h)", "(1.0 - F)"),
    "h-is-n": ("brdf.glsl", "/ (2.0 * wo_h)", "/ (2.0 * wo_h + 1e-6)"),
    "lobes-left-out": ("mixture.glsl", "D += weight.y * D_beckmann", "D += D_beckmann"),
    "weight-of-1e-7": ("mixture.glsl", "weight.y * G_v", "(1.0 - weight.x) * G_v"),
    "weights-off-by-rounding": (
        "mixture.glsl",
        "return D;",
        "return D * (1.0 + 1e4 * (weight.x + weight.y - 1.0));",
    ),
    "metallic": ("brdf.glsl", "m.albedo * INV_PI", "m.albedo"),
    "f0-at-its-ends": ("fresnel_schlick.glsl", "(1.0 - f0) * (c", "(1.001 - f0) * (c"),
    "not-quite-unit": ("fresnel_schlick.glsl", CLAMPED, "abs(1.0 - cos_theta)"),
    "beckmann-at-the-horizon": ("ndf_beckmann.glsl", "if (h.z <= 1e-6) return 0.0;", ""),
    "ggx-cancellation": ("ndf_ggx.glsl", "dot(h.xy, h.xy)", "(1.0 - h.z * h.z)"),
    "f0-out-of-gamut": ("fresnel_schlick.glsl", "return f0 +", "return clamp(f0, 0.0, 1.0) +"),
    "random-numbers-at-their-ends": ("sample_ggx.glsl", "max(1.0 - u.x, LEAST_REST)", "1.0 - u.x"),
    "frame-at-the-poles": ("frame.glsl", "n.z >= 0.0 ? 1.0 : -1.0", "sign(n.z)"),
    "map-at-the-poles": (
        "latlong.glsl",
        "world.xy == vec2(0.0) ? 0.0 : atan(world.x, world.y)",
        "acos(world.y / length(world.xy))",
    ),
    "last-point": ("hammersley.glsl", "float(i) + 0.5", "float(i) + 1.0"),
}


@pytest.mark.parametrize("name", NAMED)
def test_a_fault_on_a_hard_input_is_seen(broken, name):
    broken(*NAMED_FAULTS[name])
    assert not NAMED[name].case().passed
