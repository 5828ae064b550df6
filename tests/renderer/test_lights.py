"""Bright lights are taken out of an environment without losing any of it."""

import numpy as np
import pytest

from renderer.precompute.blurred import light_uniforms
from renderer.precompute.lights import BRIGHT, MOST, extract, texel_angles
from scenes.environment import load_environment
from scenes.suite import HERE

SHAPE = (128, 256, 3)
ANGLES = np.repeat(texel_angles(*SHAPE[:2]), SHAPE[1])


def sky() -> np.ndarray:
    return np.linspace([0.4, 0.6, 1.0], [0.2, 0.2, 0.2], SHAPE[0])[:, None, :] * np.ones(SHAPE)


def towards(row: float, column: float) -> np.ndarray:
    theta, phi = np.pi * row / (SHAPE[0] - 1), 2 * np.pi * (column + 0.5) / SHAPE[1]
    return np.array([np.sin(phi) * np.sin(theta), np.cos(phi) * np.sin(theta), np.cos(theta)])


@pytest.mark.parametrize("name", ["courtyard", "studio", "sunset", "interior"])
def test_the_lights_and_the_rest_hold_all_power(name):
    radiance = load_environment(HERE / "environments" / f"{name}.exr").radiance
    lights = extract(radiance)
    count = len(lights.solid_angle)
    assert 0 < count <= MOST
    angles = np.repeat(texel_angles(*radiance.shape[:2]), radiance.shape[1])
    for gone in (np.ones(count, bool), np.arange(count) % 2 == 0):
        rest = lights.rest(gone)
        assert rest.min() >= -1e-3 * radiance.max()
        power = angles @ rest.reshape(-1, 3).astype(float) + lights.irradiance[gone].sum(axis=0)
        assert power == pytest.approx(angles @ radiance.reshape(-1, 3).astype(float), rel=1e-4)


def test_a_plain_sky_has_no_lights():
    assert len(extract(sky()).solid_angle) == 0
    assert len(extract(np.zeros(SHAPE)).solid_angle) == 0


def test_a_sun_and_a_lamp_become_lights_where_they_are():
    radiance = sky()
    radiance[40, 70:72] = 9e4
    radiance[80:82, 200] = 3e3
    lights = extract(radiance)
    for row, column, flux in ((40, 70.5, 9e4), (80.5, 200, 3e3)):
        cosine = lights.directions @ towards(row, column)
        near = cosine > np.cos(0.03)
        middle = lights.irradiance[near].sum(axis=1) @ lights.directions[near]
        assert middle @ towards(row, column) / np.linalg.norm(middle) > np.cos(1e-3)
        span = 2 * ANGLES.reshape(SHAPE[:2])[int(row), 0]
        assert lights.irradiance[near].sum(axis=0) == pytest.approx(flux * span, rel=0.02)
        assert lights.solid_angle[near].sum() == pytest.approx(span, rel=0.05)
    assert np.delete(lights.irradiance, np.flatnonzero(near), axis=0).size


def test_a_lamp_in_its_glow_is_as_small_as_the_lamp():
    radiance = np.full(SHAPE, 0.1)
    radiance[50:70, 90:110] = 1.0
    radiance[60, 100] = 1e5
    lights = extract(radiance, most=1)
    assert lights.solid_angle[0] == pytest.approx(ANGLES.reshape(SHAPE[:2])[60, 0], rel=0.05)


def test_what_is_left_is_no_brighter_than_the_bound():
    radiance = np.random.default_rng(0).lognormal(0, 2, SHAPE)
    lights = extract(radiance)
    grey = lights.rest(np.ones(len(lights.solid_angle), bool)).mean(axis=2).ravel()
    assert grey.max() <= 1.01 * BRIGHT * np.average(grey, weights=ANGLES)
    assert len(lights.solid_angle) == MOST


@pytest.mark.parametrize("turn", [0.0, 0.3, -0.8])
def test_lights_turn_with_their_environment(turn, light):
    from renderer.precompute import precomputed
    from reports.conformance.light import Light

    radiance = np.full(SHAPE, 0.1)
    radiance[60, 30] = 1e5
    made = precomputed(light(radiance))
    made.need(["lights_map"])
    told = light_uniforms(made.maps["lights_map"], turn)
    assert told["light_count"] == 1
    direction = np.frombuffer(told["light_towards"], np.float32)[None, :3].astype(float)
    assert Light(radiance).at(direction, turn).max() > 5e4


def test_an_environment_without_lights_has_no_uniforms_of_them(light):
    from renderer.precompute import precomputed

    made = precomputed(light(0.5))
    made.need(["lights_map"])
    assert light_uniforms(made.maps["lights_map"], 0.0) == {}
