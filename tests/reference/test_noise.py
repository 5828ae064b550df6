"""The noise of batches: what every interval in `reports` rests on."""

import numpy as np
import pytest

from reference.batches import render_batch
from reference.truths import stage
from scenes.schema import Camera, Object
from tests.reference.cases import metal, plastic

SKY = np.random.default_rng(8).uniform(0, 2, (32, 64, 3))
COUNT = 64


SUN = np.full((32, 64, 3), 0.02)
SUN[5:8, 30:34] = 40.0
# Balls that mirror a sun on a floor and on each other: light paths touch more than one pixel.
FLOOR = Object(name="floor", mesh="plane", material=plastic(0.9, (0.8, 0.8, 0.8)), scale=5)
BALLS = tuple(
    Object(name=f"{x}", mesh="sphere", material=plastic(0.3, (0.8, 0.8, 0.8)), position=(x, 0, 1))
    for x in (-1.1, 1.1)
)
ABOVE = Camera(origin=(0, -5, 4), target=(0, 0, 0.5), fov=40)


@pytest.mark.parametrize("caustics", [False, True], ids=["sky", "caustics"])
def test_noise_is_independent_from_pixel_to_pixel(caustics, make_case):
    """Neighbours' correlation is that of chance, and the variance of the sum the sum of theirs."""
    case = make_case(SKY, material=metal(0.4))
    if caustics:
        case = make_case(SUN, objects=(FLOOR, *BALLS), camera=ABOVE)
    assert (stage(case, "model").caustics is not None) == caustics
    frames = [render_batch(case, "model", 4, seed) for seed in range(COUNT)]
    on_object = frames[0].ids > 0
    light = np.stack([frame.rgb.mean(axis=2) for frame in frames]).astype(np.float64)
    spread = light.std(axis=0, ddof=1)
    z = np.where(on_object, (light - light.mean(axis=0)) / np.maximum(spread, 1e-12), 0)
    for down, right in ((0, 1), (1, 0), (1, 1), (0, 2), (2, 0)):
        rows, columns = z.shape[1] - down, z.shape[2] - right
        both = on_object[down:, right:] & on_object[:rows, :columns]
        products = (z[:, down:, right:] * z[:, :rows, :columns])[:, both]
        chance = 1 / np.sqrt(products.size)
        assert abs(products.mean()) < 4 * chance, (down, right)
    whole = light[:, on_object].sum(axis=1).var(ddof=1)
    assert whole / (spread[on_object] ** 2).sum() == pytest.approx(1, abs=4 * np.sqrt(2 / COUNT))
