"""What is said of sampling a mixture holds against quadrature and against brute force."""

import numpy as np
import pytest

from reports.furnace import Surface, furnace_albedo
from reports.speed import lobes
from reports.speed.lobes import WEIGHTS, environment, facets, furnace, hammersley, needed


@pytest.mark.parametrize("cosine", [0.2, 0.9])
@pytest.mark.parametrize(
    ("sampler", "share", "weight"),
    [("ggx", 1.0, 0.0), ("ggx", 1.0, 0.5), ("mixture", 0.5, 0.5), ("beckmann", 0.0, 0.0)],
)
def test_every_sampler_has_the_furnace_albedo_as_its_mean(cosine, sampler, share, weight):
    drawn = facets(hammersley(2**16, np.array([0.3, 0.6])), cosine, 0.25, share, furnace)
    surface = Surface((0.25, 0.25), np.array([weight]), "paper")
    exact = furnace_albedo(surface, np.arccos(cosine)).item()
    # 65,536 even points: 1e-3 is twice the largest error seen, a tenth of what is asked.
    assert drawn.values(weight, sampler).mean() == pytest.approx(exact, rel=1e-3)


def test_beckmann_never_weighs_more_than_four_over_e_of_ggx():
    drawn = facets(hammersley(2**14, np.zeros(2)), 1.0, 0.25, 1.0, furnace)
    ggx, beckmann = drawn.lobes
    assert (beckmann / ggx).max() == pytest.approx(4 / np.e, rel=1e-3)


@pytest.mark.parametrize("slope", [0.5, 1.0])
def test_needed_finds_where_a_power_law_meets_the_tolerance(slope):
    sizes = 2.0 ** np.arange(15)
    squares = (0.3 * sizes**-slope) ** 2
    assert needed(squares, 0.01) == pytest.approx(30 ** (1 / slope), rel=1e-9)
    squares[12] = 0.02**2  # once within is not within for good
    assert needed(squares, 0.01) > 2**12
    assert needed(squares * 1e6, 0.01) == np.inf
    assert needed(squares * 1e-9, 0.01) == 1


@pytest.fixture(scope="module")
def measured():
    """What each sampler needs in a furnace at roughness .5, by cosine, weight, sampler, points."""
    found = lobes.lobe_sampling(roughness=(0.5,), largest=9)
    return {(f.cos_theta, f.weight, f.sampler, f.points): f.samples for f in found}


def test_random_directions_reach_the_tolerance_at_the_number_told(measured):
    told = measured[0.9, 0.5, "ggx", "random"].value
    rng, estimates = np.random.default_rng(7), []
    for _ in range(1000):
        drawn = facets(rng.random((round(told), 2)), 0.9, 0.25, 1.0, furnace)
        estimates.append(drawn.values(0.5, "ggx").mean())
    rms = np.std(estimates) / np.mean(estimates)
    assert rms == pytest.approx(0.01, rel=0.08)  # 1,000 draws know it to 2.2 %


def test_a_mixture_of_one_lobe_is_sampled_as_that_lobe(measured):
    for points in ("Hammersley", "random"):
        for weight, lobe in ((1.0, "ggx"), (0.0, "beckmann")):
            alike = measured[0.9, weight, "mixture", points], measured[0.9, weight, lobe, points]
            assert alike[0] == alike[1]


def test_beckmann_alone_never_finds_the_tail_of_ggx(measured):
    for weight in WEIGHTS[1:]:
        assert measured[0.2, weight, "beckmann", "random"].value == np.inf
        assert measured[0.2, weight, "ggx", "random"].value < 1e5


def test_intervals_hold_their_figure(measured):
    for samples in measured.values():
        assert 1 <= samples.low <= samples.value <= samples.high


def test_an_environment_is_looked_up_where_its_format_says(write_map):
    pixels = np.zeros((5, 8, 3))
    pixels[0], pixels[-1], pixels[2, 0], pixels[2, 2] = 1, 2, 3, 4
    turned = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])  # z becomes +x, y stays, x becomes -z
    light = environment(write_map(pixels), np.stack([np.eye(3), turned]))
    # The middles of columns 0 and 2 of 8 lie 22.5 and 112.5 degrees from +y towards +x.
    column = [np.array([np.sin(a), np.cos(a), 0]) for a in np.radians([22.5, 112.5])]
    poles = [np.array([0.0, 0, 1]), np.array([0.0, 0, -1])]
    seen = light(np.stack([*poles, *column]))
    np.testing.assert_allclose(seen[0], [1, 2, 3, 4], atol=1e-6)
    unturned = np.stack([*poles, *column]) @ turned  # directions that it turns to these
    np.testing.assert_allclose(light(unturned)[1], [1, 2, 3, 4], atol=1e-6)


@pytest.fixture
def write_map(tmp_path):
    """Write a radiance map (H, W, 3) and return its path."""
    import OpenImageIO as oiio

    def write(pixels):
        path = tmp_path / "map.exr"
        image = oiio.ImageBuf(np.ascontiguousarray(pixels, np.float32))
        assert image.write(str(path), oiio.FLOAT)
        return path

    return write
