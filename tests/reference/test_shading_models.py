"""The plugin `mixture` under each model: Fresnel, diffuse light, masking, and its components."""

import itertools

import drjit as dr
import numpy as np
import pytest

from reference.physical import physical_bsdf
from reference.scene_dict import model_bsdf
from reference.store import contents
from reference.variant import mitsuba
from scenes.errors import InputError
from scenes.schema import PAPER, PHYSICAL, Material, Model, Object, model_steps
from scenes.suite import Sampling
from tests.reference import formula
from tests.reference.cases import metal
from tests.reference.evaluating import chi2, directions, evaluate, only

mi = mitsuba()

DIFFUSE, GLOSSY = mi.BSDFFlags.DiffuseReflection, mi.BSDFFlags.GlossyReflection
ALBEDO = (0.6, 0.3, 0.05)
COMPENSATED = Model(fresnel="exact", kd="conserving", masking="smith", multiscatter="on")
TINTED = Model(fresnel="f82", masking="smith", multiscatter="on")
MODELS = [PAPER, *model_steps(PAPER), COMPENSATED, TINTED]
EXACT = Model(fresnel="exact")


def named(model):
    return f"{model.fresnel}-{model.kd}-{model.masking}-{model.multiscatter}"


def surface(roughness, weight=1.0, metallic=0.4, **changes):
    fields = {"albedo": ALBEDO, "f0": "acrylic", "metal": "Cu", "weight": weight} | changes
    material = Material(roughness=roughness, metallic=metallic, **fields)
    return Object(name="ball", mesh="sphere", material=material)


def plugin(obj, model):
    return mi.load_dict(model_bsdf(obj, model)[0])


def worst(found, expected):
    """Largest |difference| over max(value, 1e-4 of the peak)."""
    return np.max(np.abs(found - expected) / np.maximum(expected, 1e-4 * expected.max(axis=0)))


@pytest.mark.parametrize("metallic", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("roughness", [0.25, 0.5, 0.85])
def test_the_physical_model_of_ggx_alone_is_mitsubas_own_plugins(roughness, metallic):
    obj = surface(roughness, metallic=metallic)
    wi, wo = directions(roughness**2)
    stock = evaluate(mi.load_dict(physical_bsdf(obj)[0]), wi, wo)
    assert worst(evaluate(plugin(obj, PHYSICAL), wi, wo), stock) < 1e-4  # both are float32


@pytest.mark.parametrize("roughness", [0.25, 0.5, 0.85])
def test_the_physical_model_of_beckmann_alone_is_mitsubas_but_for_its_fit_of_masking(roughness):
    obj, alpha = surface(roughness, 0.0, metallic=1.0), roughness**2
    wi, wo = directions(alpha)
    stock = evaluate(mi.load_dict(physical_bsdf(obj)[0]), wi, wo)
    found = evaluate(plugin(obj, PHYSICAL), wi, wo)
    assert worst(found, stock) < 0.0075  # two factors, up to .35 % each
    facets = mi.MicrofacetDistribution(mi.MicrofacetType.Beckmann, alpha)
    for w in (wi, wo):  # their rational fit in place of erf
        fit = facets.smith_g1(mi.Vector3f(w.T.astype(np.float32)), mi.Vector3f(0, 0, 1)).numpy()
        found *= (fit / formula.g1_beckmann(w[:, 2], alpha))[:, None]
    assert worst(found, stock) < 1e-4


@pytest.mark.parametrize("weight", [0.25, 0.5])
def test_the_diffuse_light_of_a_mixture_is_that_of_the_truth_physical(weight):
    obj = surface(0.6, weight, metallic=0.3)
    wi, wo = directions(0.36, 2000)
    stock, ours = mi.load_dict(physical_bsdf(obj)[0]), plugin(obj, PHYSICAL)
    expected = evaluate(stock, wi, wo, only(DIFFUSE))
    assert worst(evaluate(ours, wi, wo, only(DIFFUSE)), expected) < 1e-5


@pytest.mark.parametrize("metallic", [0.0, 0.4, 1.0])
def test_exact_fresnel_is_that_of_complex_amplitudes(metallic):
    obj = surface(0.5, 0.3, metallic)
    material = obj.material
    wi, wo = directions(0.25)
    io = np.linalg.norm(wi + wo, axis=1) / 2
    F = (1 - metallic) * formula.fresnel(io, [np.mean(material.f0.eta)] * 3, [0] * 3)
    F += metallic * formula.fresnel(io, material.metal.eta, material.metal.k)
    perfect = formula.brdf(wi, wo, [0] * 3, [1] * 3, 0.25, 0.3, 0.3)
    expected = (F * perfect + (1 - F) * material.diffuse_albedo / np.pi) * wo[:, 2:]
    assert worst(evaluate(plugin(obj, EXACT), wi, wo), expected) < 1e-4


def test_the_step_of_masking_changes_nothing_but_masking():
    *_, before, after = model_steps(PAPER)
    assert (before.masking, after) == ("paper", PHYSICAL)
    obj = surface(0.6, 0.4)
    wi, wo = directions(0.36, 2000)

    def values(model, flag):
        return evaluate(plugin(obj, model), wi, wo, only(flag))

    np.testing.assert_array_equal(values(before, DIFFUSE), values(after, DIFFUSE))
    ratio = values(after, GLOSSY) / values(before, GLOSSY)
    paper, smith = (formula.brdf(wi, wo, [0], [1], 0.36, 0.4, 0.4, m) for m in ("paper", "smith"))
    np.testing.assert_allclose(ratio, np.broadcast_to(smith / paper, ratio.shape), rtol=1e-4)


@pytest.mark.parametrize("model", MODELS, ids=named)
def test_glossy_and_diffuse_light_add_up_and_can_be_asked_for_apart(model):
    bsdf = plugin(surface(0.5, 0.4, metallic=0.2), model)
    wi, wo = directions(0.25, 2000)
    glossy, diffuse = (evaluate(bsdf, wi, wo, only(flag)) for flag in (GLOSSY, DIFFUSE))
    np.testing.assert_allclose(glossy + diffuse, evaluate(bsdf, wi, wo), rtol=1e-6)
    assert min(glossy.min(), diffuse.min()) > 0
    assert [bsdf.flags(i) & (GLOSSY | DIFFUSE) for i in range(2)] == [GLOSSY, DIFFUSE]
    for component, expected in enumerate((glossy, diffuse)):
        context = mi.BSDFContext()
        context.component = component
        np.testing.assert_array_equal(evaluate(bsdf, wi, wo, context), expected)


def test_a_surface_without_diffuse_light_has_one_component():
    bsdf = plugin(surface(0.5, metallic=1.0), PHYSICAL)
    wi, wo = directions(0.25, 100)
    assert bsdf.component_count() == 1
    assert (evaluate(bsdf, wi, wo, only(DIFFUSE)) == 0).all()


CHI2 = list(
    itertools.product((0.15, 0.6), (0.0, 0.4, 1.0), (GLOSSY | DIFFUSE, GLOSSY, DIFFUSE), (20, 80))
)


@pytest.mark.parametrize(("alpha", "weight", "asked", "degrees"), CHI2)
def test_samples_have_the_density_that_pdf_says(
    alpha, weight, asked, degrees, monkeypatch, tmp_path
):
    monkeypatch.chdir(tmp_path)  # where a failing test leaves its histogram
    test = chi2(plugin(surface(alpha**0.5, weight), PHYSICAL), degrees, only(asked))
    # Sidak's correction over the parameters, in `test_count`.
    assert test.run(significance_level=0.01, test_count=len(CHI2), quiet=True), test.messages


@pytest.mark.parametrize(
    "asked", [GLOSSY | DIFFUSE, GLOSSY, DIFFUSE], ids=["all", "glossy", "diffuse"]
)
@pytest.mark.parametrize("model", MODELS, ids=named)
def test_sampling_estimates_what_uniform_directions_do(model, asked):
    bsdf, context, count = plugin(surface(0.6, 0.4), model), only(asked), 1 << 19
    si = dr.zeros(mi.SurfaceInteraction3f, count)
    si.wi = mi.Vector3f(0.8, 0, 0.6)
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(1, count)
    bs, drawn = bsdf.sample(context, si, sampler.next_1d(), sampler.next_2d())
    seen = {int(t) for t in np.unique(bs.sampled_type.numpy())}
    assert seen == {int(f) for f in (GLOSSY, DIFFUSE) if int(f) & int(asked)}
    uniform = mi.warp.square_to_uniform_hemisphere(sampler.next_2d())
    even = bsdf.eval(context, si, uniform) / mi.warp.square_to_uniform_hemisphere_pdf(uniform)
    drawn, even = drawn.numpy(), even.numpy()
    error = np.hypot(drawn.std(axis=1), even.std(axis=1)) / count**0.5
    assert np.all(np.abs(drawn.mean(axis=1) - even.mean(axis=1)) < 4.5 * error)


@pytest.mark.parametrize("asked", [GLOSSY | DIFFUSE, GLOSSY])
@pytest.mark.parametrize("metallic", [0.4, 1.0])
def test_samples_of_compensated_facets_have_the_density_that_pdf_says(
    asked, metallic, monkeypatch, tmp_path
):
    monkeypatch.chdir(tmp_path)
    test = chi2(plugin(surface(0.5, 0.4, metallic), COMPENSATED), 50, only(asked))
    assert test.run(significance_level=0.01, test_count=4, quiet=True), test.messages


@pytest.mark.parametrize(
    ("f0", "kd"),
    [(0.0, "conserving"), (0.04, "conserving"), (1.0, "conserving"), (1.0, "one-minus-fresnel")],
)
@pytest.mark.parametrize("weight", [0.0, 0.5, 1.0])
def test_a_white_surface_sends_back_all_that_comes(f0, kd, weight):
    model = Model(kd=kd, masking="smith", multiscatter="on")
    white = surface(0.8, weight, 0.0, f0=f0, albedo=(1.0, 1.0, 1.0))
    x, w = np.polynomial.legendre.leggauss(256)
    mu, turn = (x + 1) / 2, (np.arange(128) + 0.5) / 128 * 2 * np.pi
    mu, turn = (a.ravel() for a in np.meshgrid(mu, turn))
    wo = np.stack([np.sqrt(1 - mu**2) * np.cos(turn), np.sqrt(1 - mu**2) * np.sin(turn), mu], 1)
    for cosine in (0.1, 0.5, 0.95):
        wi = np.broadcast_to([np.sqrt(1 - cosine**2), 0, cosine], wo.shape)
        sent = np.tile(w, 128) @ evaluate(plugin(white, model), wi, wo) / 128 * np.pi
        assert sent == pytest.approx(1, abs=1e-3)


def test_f82_is_the_metals_own_reflectance_where_the_cosine_is_a_seventh():
    obj = surface(0.5, metallic=1.0)
    metal, at = obj.material.metal, np.array([1 / 7])
    wi = np.array([[np.sqrt(48) / 7, 0, 1 / 7]])
    both = [evaluate(plugin(obj, m), wi, wi * [-1, 1, 1]) for m in (Model(fresnel="f82"), EXACT)]
    # Mirrored directions: h is n, and h.wi the cosine.
    np.testing.assert_allclose(*both, rtol=1e-5)
    expected = formula.fresnel(at, metal.eta, metal.k)[0]
    np.testing.assert_allclose(metal.f82, expected, rtol=1e-12)


def test_a_metal_of_bare_f0_has_no_exact_fresnel():
    obj = Object(name="ball", mesh="sphere", material=metal(f0=(0.9, 0.6, 0.5)))
    with pytest.raises(InputError, match=r"'ball'.*name a metal"):
        model_bsdf(obj, EXACT)


def test_a_dielectric_that_reflects_all_has_no_exact_fresnel():
    obj = surface(0.5, metallic=0.0, f0=1.0)
    with pytest.raises(InputError, match=r"'ball'.*below 1"):
        model_bsdf(obj, EXACT)


def test_one_eta_for_all_channels_is_told():
    obj = surface(0.5, metallic=0.0, f0=(0.02, 0.04, 0.08))
    assert "F0 is 0.04" in model_bsdf(obj, EXACT)[1][0]
    assert model_bsdf(obj, PAPER)[1] == []


def test_a_reference_is_keyed_by_what_its_model_reads(make_case):
    copper = metal(f0="Cu")
    other = copper.metal.model_copy(update={"k": (1.0, 1.0, 1.0)})
    same_f0 = copper.model_copy(update={"metal": other})

    def key(material, model):
        return contents(make_case(material=material, model=model), "model", Sampling())

    assert key(copper, PAPER)["objects"] == key(same_f0, PAPER)["objects"]
    assert key(copper, EXACT)["objects"] != key(same_f0, EXACT)["objects"]
    assert len({str(key(copper, model)) for model in MODELS}) == len(MODELS)


@pytest.mark.parametrize("model", MODELS, ids=named)
def test_one_compiled_kernel_serves_every_material_of_a_model(model):
    def kernels(obj):
        bsdf, count = plugin(obj, model), 64
        si = dr.zeros(mi.SurfaceInteraction3f, count)
        si.wi = dr.opaque(mi.Vector3f, 0.6)
        first, second = (dr.opaque(kind, 0.3, count) for kind in (mi.Float, mi.Point2f))
        with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
            dr.kernel_history_clear()
            dr.eval(bsdf.sample(mi.BSDFContext(), si, first, second))
            return tuple(str(k["hash"]) for k in dr.kernel_history([dr.KernelType.JIT]))

    one = surface(0.5, 0.4)
    other = surface(0.7, 0.6, 0.5, albedo=(0.1, 0.2, 0.3), f0="water", metal="Au")
    # Dr.Jit orders some gathers by where memory happens to lie: the same material can give two
    # kernels, too. Numbers that are written into a kernel would never give a common one.
    assert {kernels(one) for _ in range(6)} & {kernels(other) for _ in range(6)}
