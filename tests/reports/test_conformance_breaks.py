"""Each check of conformance sees the fault that it is there for."""

import pytest

from renderer import precompute
from renderer.precompute import brdf_table, irradiance, prefilter
from renderer.techniques import technique
from reports.conformance import documented
from reports.conformance.light import Light
from reports.run.conformance.maps import of_maps, of_sizes
from reports.run.conformance.samples import of_samples
from reports.run.conformance.shading import of_beckmann_over_ggx
from reports.run.conformance.shared import uniforms_of
from reports.run.conformance.surfaces import of_surfaces
from reports.run.stability.materials import beside_oracle
from scenes.environment import load_environment
from scenes.schema import Material, Model
from scenes.suite import expand, load_suite


@pytest.fixture(params=[0.1, 0.2, 0.5])
def plastic(request):
    """A surface whose lobe's peak is far above its diffuse light."""
    return Material(
        albedo=(0.6, 0.3, 0.05), roughness=request.param, metallic=0.0, f0=0.04, weight=0.5
    )


def test_half_of_the_diffuse_light_is_missed(broken, plastic):
    assert beside_oracle(plastic, Model()).passed
    broken("brdf.glsl", "m.albedo * INV_PI", "0.5 * m.albedo * INV_PI")
    assert not beside_oracle(plastic, Model()).passed


def test_half_of_the_diffuse_samples_density_is_missed(broken, plastic):
    def holds():
        (found,) = (f for f in of_samples(plastic, technique("sampled")) if f.name == "densities")
        return found.passed

    assert holds()
    broken("density.glsl", "wi.z * INV_PI", "0.5 * wi.z * INV_PI")
    assert not holds()


@pytest.mark.parametrize(
    ("right", "wrong"),
    [("80.0", "10.0"), ("80.0", "8.0"), ("exp(-t)", "exp(-t) * 1.0002"), ("* (1.0 + t);", ";")],
)
def test_a_wrong_weight_of_ggx_samples_for_beckmann_is_seen(broken, right, wrong):
    alphas = {1e-4, 0.04, 0.36, 1.0}
    assert of_beckmann_over_ggx(alphas).passed
    broken("beckmann_over_ggx.glsl", right, wrong)
    assert not of_beckmann_over_ggx(alphas).passed


@pytest.mark.parametrize(
    ("field", "least"), [("alpha", 0.0024), ("specular_f0", 0.035), ("diffuse_albedo", 0.01)]
)
def test_a_material_that_is_clamped_is_seen(monkeypatch, field, least):
    case = next(e.case for e in expand(*load_suite("guard")) if e.case.scene == "ends")
    assert all(f.passed for f in of_surfaces(case, "paper"))
    right = getattr(Material, field).fget

    def clamped(material):
        value = right(material)
        return max(value, least) if field == "alpha" else tuple(max(c, least) for c in value)

    told = {o.name: uniforms_of(o.material) for o in case.objects}
    materials = {o.material: o.name for o in case.objects}
    monkeypatch.setattr(
        "reports.run.conformance.surfaces.uniforms_of", lambda m: told[materials[m]]
    )
    monkeypatch.setattr(Material, field, property(clamped))
    assert not all(f.passed for f in of_surfaces(case, "paper"))


@pytest.fixture
def remade():
    """Forget maps of other shaders, before and after."""

    def forget():
        precompute._cached.cache_clear()
        brdf_table._made.cache_clear()

    forget()
    yield
    forget()


@pytest.fixture(scope="module")
def courtyard():
    entries = expand(*load_suite("guard"))
    return next(e.case.environment.path for e in entries if "courtyard" in e.case.id)


SIZES = [
    (prefilter, "LEVELS", 5),
    (prefilter, "SIZE", (256, 128)),
    (irradiance, "SIZES", {"irradiance_map": (8, 8)}),
    (brdf_table, "SIZE", (64, 64)),
]


@pytest.mark.parametrize(("module", "constant", "value"), SIZES, ids=lambda v: str(v)[-20:])
def test_a_smaller_map_than_the_papers_is_seen(
    monkeypatch, remade, courtyard, module, constant, value
):
    monkeypatch.setattr(module, constant, value)
    made = precompute.precomputed(courtyard)
    made.need(documented.SIZES)
    assert not all(f.passed for f in of_sizes(made, set(documented.SIZES)))


def test_fewer_points_than_the_papers_are_seen(monkeypatch, remade, courtyard):
    """What is allowed for a map's noise is not asked of the renderer."""
    monkeypatch.setattr(prefilter, "SAMPLES", 256)
    made = precompute.precomputed(courtyard)
    made.need(["prefiltered_ggx"])
    light = Light(load_environment(courtyard).radiance)
    found = of_maps(made, light, {"prefiltered_ggx"}, "courtyard")
    failed = {(f.name, f.place) for f in found if not f.passed}
    # Of the rough level nothing but the allowance tells: with that of 256 points it would pass.
    assert ("prefiltered maps", "prefiltered_ggx, level 5, of courtyard") in failed
