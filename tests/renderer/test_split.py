"""The better split sum is better than the paper's, and costs no more maps than a material needs."""

from dataclasses import replace

import numpy as np
import pytest

from renderer.draw import Renderer
from renderer.techniques import technique
from scenes.schema import Material, Model
from scenes.suite import HERE

PLASTIC = Material(albedo=(0.6, 0.3, 0.05), roughness=0.7, metallic=0.0)


def draw(name, case):
    return Renderer(replace(technique(name), msaa=0), repeats=0).render(case)


@pytest.mark.parametrize(("weight", "masking"), [(1.0, "paper"), (0.5, "smith"), (0.0, "paper")])
@pytest.mark.parametrize("name", ["courtyard", "studio", "sunset", "interior"])
def test_split_is_nearer_than_paper(make_case, copper, name, weight, masking):
    ball = ("sphere", copper(0.36, weight), {})
    case = make_case(HERE / "environments" / f"{name}.exr", ball, size=(48, 36))
    case = case.model_copy(update={"model": Model(masking=masking)})
    truth = draw("filtered@512", case)
    on = truth.ids > 0

    def off(technique_name):
        return np.abs(draw(technique_name, case).rgb[on] / truth.rgb[on] - 1).mean()

    assert off("split") < 0.85 * off("paper")


def test_even_light_is_reflected_as_the_model_says(light, make_case):
    case = make_case(light(1.0), ("plane", PLASTIC, {"scale": 4.0, "rotate": (70.0, 0.0, 0.0)}))
    ours, truth = draw("split", case), draw("sampled@4096", case)
    on = truth.ids > 0
    assert ours.rgb[on] == pytest.approx(truth.rgb[on], rel=0.02)


def test_only_the_maps_of_the_lobes_are_read(copper):
    how = technique("split")
    assert how.maps(copper(0.2, 1.0)) == ("lobe_ggx", "albedo_ggx", "towards_ggx")
    assert "irradiance_exact" in how.maps(PLASTIC)
    assert not any("beckmann" in name for name in how.maps(PLASTIC))
