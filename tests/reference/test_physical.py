"""The truth `physical`: stock plugins that mean what the material says."""

import drjit as dr
import numpy as np
import pytest

from reference.physical import blend, physical_bsdf
from reference.variant import mitsuba
from scenes.errors import InputError
from scenes.schema import Object
from tests.reference.cases import metal, plastic

mi = mitsuba()


def bsdf_of(material):
    return physical_bsdf(Object(name="ball", mesh="sphere", material=material))


def evaluate(plugin, wi=(0.6, 0, 0.8), wo=(-0.5, 0.1, 0.86)):
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi = dr.normalize(mi.Vector3f(wi))
    value = mi.load_dict(plugin).eval(mi.BSDFContext(), si, dr.normalize(mi.Vector3f(wo)))
    return np.array(value).ravel()


@pytest.mark.parametrize("alpha", [0.04, 0.49])
@pytest.mark.parametrize("asked", [(0.45, 0.2, 0.05), (1.0, 0.6, 0.0)])
def test_a_solved_plastic_seen_from_outside_has_the_albedo_asked_for(alpha, asked):
    """At alpha .49 an outer albedo over .48 takes an inner reflectance over 1."""
    count = 1 << 20
    bsdf = mi.load_dict(bsdf_of(plastic(albedo=asked, roughness=alpha**0.5))[0])
    # Uniform light, by Monte Carlo: light of cosine density weighted by the plugin's own samples.
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(3, count)
    si = dr.zeros(mi.SurfaceInteraction3f, count)
    si.wi = mi.warp.square_to_cosine_hemisphere(sampler.next_2d())
    context = mi.BSDFContext()
    context.component = 1
    assert mi.has_flag(bsdf.flags(1), mi.BSDFFlags.DiffuseReflection)
    weight = bsdf.sample(context, si, sampler.next_1d(), sampler.next_2d())[1].numpy()
    assert weight.mean(axis=1) == pytest.approx(asked, rel=0.005, abs=1e-6)


def test_a_coloured_dielectric_says_that_its_f0_became_grey():
    plugin, notes = bsdf_of(plastic(f0=(0.02, 0.04, 0.08)))
    assert plugin["int_ior"] == pytest.approx(1.5, abs=0.05)
    assert any("F0" in note for note in notes)


def test_a_metal_without_eta_and_k_is_refused_by_name():
    with pytest.raises(InputError, match=r"'ball'.*name a metal"):
        bsdf_of(metal(f0=(0.9, 0.6, 0.5)))


def test_a_metal_gets_its_own_eta_and_k_and_an_explicit_distribution():
    material = metal(f0="Cu", weight=0)
    plugin, _ = bsdf_of(material)
    assert plugin["type"] == "roughconductor"
    assert plugin["distribution"] == "beckmann"
    assert plugin["alpha"] == material.alpha
    # At normal incidence off a smooth surface the plugin's Fresnel is the material's F0.
    mirror = mi.load_dict(plugin | {"alpha": 1e-3})
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi = mi.Vector3f(0, 0, 1)
    weight = mirror.sample(mi.BSDFContext(), si, 0.5, mi.Point2f(0.5))[1]
    assert np.array(weight).ravel() == pytest.approx(material.metal.f0, abs=1e-3)


def test_a_blend_counts_its_weight_from_the_first_to_the_second():
    first, second = (
        {"type": "diffuse", "reflectance": {"type": "rgb", "value": v}} for v in (0.2, 0.8)
    )
    assert blend(first, second, 0) is first
    assert blend(first, second, 1) is second
    for weight in (1e-6, 0.25, 1 - 1e-6):
        expected = (1 - weight) * evaluate(first) + weight * evaluate(second)
        assert evaluate(blend(first, second, weight)) == pytest.approx(expected, rel=1e-5)


def test_mixtures_are_shares_of_their_ends():
    def value(metallic, weight):
        material = plastic(metallic=metallic, metal="Au", weight=weight)
        return evaluate(bsdf_of(material.model_copy(update={"metallic": metallic}))[0])

    expected = 0.7 * (0.6 * value(0, 0) + 0.4 * value(0, 1))
    expected += 0.3 * (0.6 * value(1, 0) + 0.4 * value(1, 1))
    assert value(0.3, 0.4) == pytest.approx(expected, rel=1e-4)
