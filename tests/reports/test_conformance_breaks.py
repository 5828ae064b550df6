"""Each check of conformance sees the fault that it is there for."""

import pytest

from renderer.features import technique
from reports.run.conformance.samples import of_samples
from reports.run.stability.materials import beside_oracle
from scenes.schema import Material, Model


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
    broken("shade_sampled.glsl", "wi.z * INV_PI", "0.5 * wi.z * INV_PI")
    assert not holds()
