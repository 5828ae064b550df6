"""What a specular lobe does not send back, against double precision."""

import numpy as np
import pytest

from renderer.precompute import lost_light
from renderer.surface import surface_uniforms
from reports.furnace import Surface, furnace_albedo
from reports.stability.models import transmitted
from scenes.schema import PHYSICAL, Material, Model

Y = lost_light.PLACES**4
COSINES = np.maximum(Y * (2 - Y), 1e-6)
SOME = range(16, lost_light.NODES - 1, 9)
ON = Model(multiscatter="on", masking="smith")


@pytest.mark.parametrize("masking", ["paper", "smith"])
@pytest.mark.parametrize("alpha", [0.01, 0.1, 1.0])
@pytest.mark.parametrize("weight", [0.0, 0.4, 1.0])
def test_losses_are_the_integral(masking, alpha, weight):
    metal = (0.04, 0.5, 1.0)
    material = Material(roughness=alpha**0.5, metallic=1, metal=metal, weight=weight)
    told = tuple(surface_uniforms(material).items())
    model = Model(masking=masking, multiscatter="on")
    losses, F = lost_light._losses_and_fresnel(told, frozenset(), model)
    mixture = Surface((alpha, alpha), np.array([weight]), masking)
    for node in SOME:
        albedo = furnace_albedo(mixture, np.arccos(COSINES[node]), (0.04, 0.5, 1.0, 1.0))[:, 0]
        # 262,144 points: cavities' edges in azimuth leave 5e-5 where wo grazes.
        np.testing.assert_allclose(losses[node], 1 - albedo, atol=5e-5)
    np.testing.assert_allclose(F[-1], [0.04, 0.5, 1.0, 1.0], atol=1e-6)


def test_what_passes_a_rough_interface_is_the_integral():
    told = {"alpha": 0.5, "eta": 1.49}
    passed = lost_light._run("interface.frag", frozenset(), told, 1)[0, :, :2]
    for node in SOME:
        np.testing.assert_allclose(passed[node], transmitted(1.49, 0.5, COSINES[node]), atol=2e-5)


def test_weights_share_what_their_pairs_lose(copper):
    paper = Model(multiscatter="on")
    one = [lost_light.lost_light(copper(0.3, w), paper) for w in (0.25, 0.75)]
    before = lost_light._integrated.cache_info().misses
    lost_light.lost_light(copper(0.3, 0.6), paper)
    assert lost_light._integrated.cache_info().misses == before and one[0] is not one[1]


def test_a_map_is_made_once_per_surface_and_model(copper):
    assert lost_light.lost_light(copper(0.3), ON) is lost_light.lost_light(
        copper(0.3, name="again"), ON
    )
    assert lost_light.lost_light(copper(0.3), ON).seconds > 0


def test_a_perfect_mirror_loses_nothing_and_its_map_is_finite():
    mirror = Material(albedo=(0.5,) * 3, roughness=0.0, metallic=0.0, f0=1.0)
    made = lost_light.lost_light(mirror, Model(kd="conserving", multiscatter="on"))
    texels = np.frombuffer(made.texture.read(), np.float32)
    assert np.isfinite(texels).all() and texels.min() >= 0


def test_a_model_asks_for_an_eta_that_there_is():
    bare = Material(roughness=0.5, metallic=1, metal=(0.9, 0.5, 0.3))
    with pytest.raises(ValueError, match="name a metal"):
        surface_uniforms(bare, PHYSICAL)
