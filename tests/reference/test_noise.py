"""The noise of batches: what every interval in `reports` rests on."""

import numpy as np
import pytest

from reference.batches import render_batch
from tests.reference.cases import metal

SKY = np.random.default_rng(8).uniform(0, 2, (32, 64, 3))
COUNT = 64


def test_noise_is_independent_from_pixel_to_pixel(make_case):
    """Neighbours' correlation is that of chance, and the variance of the sum the sum of theirs."""
    case = make_case(SKY, material=metal(0.4))
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
