"""A picture drawn in parts is the picture."""

from dataclasses import replace

import numpy as np
import pytest

from renderer.draw import Renderer
from renderer.targets import make_target, within
from renderer.techniques import technique
from scenes.schema import Material

PLASTIC = Material(albedo=(0.6, 0.3, 0.05), roughness=0.6, metallic=0.0, weight=0.5)
WHOLE = (0, 0, 90, 70)
PARTS = {
    "halves": [(0, 0, 45, 70), (45, 0, 45, 70)],
    "rows": [(0, 0, 90, 33), (0, 33, 90, 37)],
    "corners": [(0, 0, 17, 11), (17, 0, 73, 11), (0, 11, 17, 59), (17, 11, 73, 59)],
}


@pytest.mark.parametrize("name", ["paper", "paper-noaa", "sampled", "sampled@1", "twice"])
@pytest.mark.parametrize("split", PARTS)
def test_parts_show_what_the_whole_shows(light, make_case, copper, name, split):
    """Pixel by pixel, jitter and coverage samples too."""
    sky = np.random.default_rng(0).uniform(0.5, 1.5, (16, 32, 3))
    balls = [
        ("sphere", copper(0.3, 0.5), {"position": (0.5, 0, 0.2), "scale": 0.6}),
        ("sphere", PLASTIC, {"position": (-0.6, 1.5, 0.4)}),
    ]
    case = make_case(light(sky), *balls, size=WHOLE[2:])
    how = replace(technique("paper"), supersample=2) if name == "twice" else technique(name)
    renderer = Renderer(how, repeats=0)
    whole = renderer.render(case)
    for left, bottom, width, height in PARTS[split]:
        part = renderer.render(case, (left, bottom, width, height))
        rows = slice(case.height - bottom - height, case.height - bottom)
        columns = slice(left, left + width)
        assert part.rgb.shape == (height, width, 3)
        np.testing.assert_array_equal(part.ids, whole.ids[rows, columns])
        # Mesa interpolates normals from the framebuffer's corner, and rounds there: 3e-5 in a few
        # pixels whose triangles are tiny, 1e-6 in all.
        shown = whole.rgb[rows, columns]
        off = (part.rgb - shown) / np.maximum(shown, 1e-9)  # 0 where a normal faces away
        assert np.abs(off).max() < 1e-4 and np.sqrt((off**2).mean()) < 2e-6


def test_what_lies_outside_of_a_part_is_nothing_of_it():
    assert within((10, 10, 5, 5), (12, 8, 4, 4)) == (0, 2, 3, 2)
    assert within((10, 10, 5, 5), (15, 0, 9, 99)) == (0, 0, 0, 0)


@pytest.mark.parametrize(
    ("size", "part", "msaa", "said"),
    [
        ((8, 8), (0, 0, 8, 8), 1024, "1024 samples a pixel"),
        ((1 << 20, 8), (0, 0, 8, 8), 4, "1048576 pixels a side"),
        ((8, 8), (0, 0, 1 << 20, 1), 0, "1048576 pixels a side"),
    ],
)
def test_what_the_driver_cannot_draw_is_refused_in_one_line(refused, size, part, msaa, said):
    refused(lambda: make_target(size, msaa, part, part), "OpenGL", said, "at most")
