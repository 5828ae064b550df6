"""The environment on the GPU: directions, filtered levels, and what lies where."""

import numpy as np
import pytest

from renderer.precompute import Precomputed, irradiance, prefilter
from renderer.precompute.radiance import make, pyramid
from renderer.probe import probe

# Of a turn. GLSL promises atan to 4,096 ULP only (GLSL 4.60, 4.7.1), which is 1.6e-4; drivers come
# to about 1e-6. This is 1/15 texel of the widest map there can be, 16,384 texels.
UV_ERROR = 4e-6
MAP = ("irradiance_map",)
SIZES = [(16, 32), (256, 512), (15, 31), (7, 13), (1, 2), (2, 2), (3, 5)]


def unit(count: int) -> np.ndarray:
    """Directions (n, 3) float32: random ones, the poles, near them, and along the seam."""
    d = np.random.default_rng(5).normal(size=(count, 3))
    tilt = np.array([1e-6, 1e-4, 1e-2])
    poles = [[0, 0, 1], [0, 0, -1], *([t, -t, s] for t in tilt for s in (1, -1))]
    seam = [[s * t, -1, z] for t in (0, 1e-6, 1e-3) for s in (1, -1) for z in (-1, 0, 2)]
    d = np.concatenate([d, poles, seam])
    return (d / np.linalg.norm(d, axis=1, keepdims=True)).astype(np.float32)


@pytest.mark.parametrize("turn", [0.0, 0.3, -1.25])
def test_latlong_there_and_back(turn):
    d = unit(5000)
    call = f"direction_from_latlong(latlong_from_direction(d.xyz, {turn}), {turn})"
    back = probe(f"vec4({call}, 0.0)", {"d": d}, ("latlong.glsl",))[:, :3]
    # A turn in radians; sin, cos and a turn above 1 cost a little more.
    np.testing.assert_allclose(back, d, atol=2 * np.pi * UV_ERROR + 5e-6)


def test_latlong_is_azimuth_from_y_and_angle_from_the_pole():
    d = unit(5000)
    uv = probe("vec4(latlong_from_direction(d.xyz, 0.25), 0.0, 0.0)", {"d": d}, ("latlong.glsl",))
    x, y, z = d.astype(float).T
    expected = np.arctan2(x, y) / (2 * np.pi) + 0.25
    # Exactly on the seam both ends are right.
    apart = np.abs(uv[:, 0] - expected)
    assert np.minimum(apart, 1 - apart).max() < UV_ERROR
    np.testing.assert_allclose(uv[:, 1], np.arctan2(np.hypot(x, y), z) / np.pi, atol=UV_ERROR)


def band_weights(height: int, base: int) -> np.ndarray:
    """The solid angle of each row of a level, whose base has rows aligned to the poles."""
    edge = np.arange(height + 1) * base / height - 0.5
    theta = np.clip(edge / max(base - 1, 1), 0, 1) * np.pi
    return -np.diff(np.cos(theta))


@pytest.mark.parametrize("size", SIZES, ids=str)
def test_every_level_keeps_the_power(size):
    radiance = np.random.default_rng(2).exponential(1, (*size, 3)) ** 3
    levels = pyramid(radiance)
    assert levels[-1].shape == (1, 1, 3)
    powers = [
        np.einsum("r,rck->k", band_weights(len(level), size[0]), level) / level.shape[1]
        for level in levels
    ]
    even = all(n & (n - 1) == 0 for n in size)
    # A row of odd size is split by height, not by solid angle, which moves a little power.
    np.testing.assert_allclose(powers / powers[0], 1, rtol=1e-5 if even else 0.01)


@pytest.mark.parametrize("size", SIZES, ids=str)
def test_a_constant_map_is_constant_on_every_level(size):
    for level in pyramid(np.full((*size, 3), 2.5)):
        np.testing.assert_allclose(level, 2.5, rtol=1e-6)


def test_every_level_is_on_the_gpu(light):
    radiance = np.random.default_rng(2).uniform(0, 1, (12, 20, 3)).astype(np.float32)
    texture = make(light(radiance))
    for number, level in enumerate(pyramid(radiance)):
        stored = np.frombuffer(texture.read(level=number), np.float32).reshape(*level.shape[:2], 4)
        np.testing.assert_array_equal(stored[..., :3], level)


def look_up(expression: str, directions: np.ndarray, texture) -> np.ndarray:
    """Evaluate an expression of a direction d beside the radiance map."""
    texture.use(5)
    uniforms = {"radiance_map": 5, "environment_turn": 0.0}
    return probe(expression, {"d": directions}, ("radiance.glsl",), uniforms=uniforms)


def test_radiance_is_bilinear_between_texel_centres_and_pole_rows(light):
    height, width = 8, 16
    radiance = np.random.default_rng(4).uniform(0, 1, (height, width, 3)).astype(np.float32)
    d = unit(3000).astype(float)
    row = np.arctan2(np.hypot(d[:, 0], d[:, 1]), d[:, 2]) / np.pi * (height - 1)
    column = np.arctan2(d[:, 0], d[:, 1]) / (2 * np.pi) * width - 0.5
    r, c = np.minimum(row.astype(int), height - 2), np.floor(column).astype(int)
    fr, fc = (row - r)[:, None], (column - c)[:, None]
    a, b = radiance[r], radiance[r + 1]
    left, right = c % width, (c + 1) % width
    n = np.arange(len(d))
    expected = (1 - fr) * ((1 - fc) * a[n, left] + fc * a[n, right])
    expected += fr * ((1 - fc) * b[n, left] + fc * b[n, right])
    ours = look_up("vec4(radiance(d.xyz, 0.0), 0.0)", d, make(light(radiance)))[:, :3]
    # Texture units may keep only 8 bits of the fraction. At a pole no azimuth is right.
    off = np.abs(ours - expected)[np.hypot(d[:, 0], d[:, 1]) > 1e-5]
    assert off.max() < 2 / 256


def test_a_sample_is_filtered_over_its_own_solid_angle(light):
    height, width = 256, 512
    texture = make(light(1.0, (height, width)))
    theta = np.radians(np.array([10, 30, 60, 90, 120, 170.0]))
    d = np.stack([np.sin(theta), 0 * theta, np.cos(theta)], axis=1)
    half = np.pi / (height - 1) / 2
    texel = 2 * np.pi / width * (np.cos(theta - half) - np.cos(theta + half))
    for level in (0, 1, 3.5, 6):
        # One of 64 samples has 1 / (64 pdf): 4^level texels.
        pdf = 1 / (64 * texel * 4**level)
        found = look_up("vec4(radiance_lod(d.xyz, d.w, 64.0))", np.column_stack([d, pdf]), texture)
        np.testing.assert_allclose(found[:, 0], level, atol=1e-3)
    dense = look_up("vec4(radiance_lod(d.xyz, 1e9, 64.0))", d, texture)
    assert (dense == 0).all()


def texels(texture, level: int = 0) -> np.ndarray:
    width, height = (max(n >> level, 1) for n in texture.size)
    return np.frombuffer(texture.read(level=level), np.float32).reshape(height, width, 4)


def normals_of(size: tuple[int, int]) -> np.ndarray:
    """The direction of each texel's centre of a map (W, H) that is not aligned to the poles."""
    theta = (np.arange(size[1]) + 0.5)[:, None] / size[1] * np.pi
    phi = (np.arange(size[0]) + 0.5)[None] / size[0] * 2 * np.pi
    both = [np.sin(phi) * np.sin(theta), np.cos(phi) * np.sin(theta), np.cos(theta) + 0 * phi]
    return np.stack(both, axis=2)


# A shader's loops end early on Mesa: not every size may be summed texel by texel.
LARGE = [(512, 1024), (255, 511), (400, 400), (2, 4096), (4096, 2)]


@pytest.mark.parametrize("size", [*SIZES, *LARGE], ids=str)
def test_irradiance_of_constant_light_is_pi_everywhere(light, size):
    made = irradiance.make(make(light((0.5, 1.0, 4.0), size)), MAP)["irradiance_map"]
    assert made.size == (16, 16)
    # At least 128x64 cells: the midpoint rule errs by up to 6e-4.
    np.testing.assert_allclose(
        texels(made)[..., :3] / [0.5, 1, 4], np.broadcast_to(np.pi, (16, 16, 3)), rtol=1e-3
    )


@pytest.mark.parametrize("row", [0, 3, 100, 128, 255])
def test_irradiance_of_one_bright_texel_is_a_cosine(light, row):
    height, width, column = 256, 512, 77
    sun = np.zeros((height, width, 3))
    sun[row, column] = 1e5
    made = texels(irradiance.make(make(light(sun)), MAP)["irradiance_map"])[..., 0]
    theta, phi = row * np.pi / (height - 1), (column + 0.5) / width * 2 * np.pi
    to_sun = [np.sin(phi) * np.sin(theta), np.cos(phi) * np.sin(theta), np.cos(theta)]
    power = 1e5 * 2 * np.pi / width * band_weights(height, height)[row]
    expected = power * np.maximum(normals_of((16, 16)) @ to_sun, 0)
    # The sum runs over texels twice as wide, so the sun may stand one fine texel off: .7 degrees.
    np.testing.assert_allclose(made, expected, atol=0.02 * expected.max())


def test_prefiltered_constant_light_is_constant_at_every_weight(light):
    made = prefilter.make(make(light((0.5, 1.0, 4.0))), prefilter.LOBES)
    for level in range(prefilter.LEVELS):
        ggx, beckmann = (texels(made[f"prefiltered_{n}"], level) for n in ("ggx", "beckmann"))
        assert min(ggx[..., 3].min(), beckmann[..., 3].min()) > 0
        for weight in (0, 0.25, 0.5, 1):
            mixed = weight * ggx + (1 - weight) * beckmann
            found = mixed[..., :3] / mixed[..., 3:]
            np.testing.assert_allclose(found, np.broadcast_to([0.5, 1, 4], found.shape), rtol=1e-5)


def test_prefiltered_light_is_symmetric_about_a_symmetric_sky(light):
    sky = np.zeros((64, 128, 3))
    sky[:20] = 1.0
    for texture in prefilter.make(make(light(sky)), prefilter.LOBES).values():
        for level in range(prefilter.LEVELS):
            made = texels(texture, level)
            found = made[..., 0] / made[..., 3]
            # 1,024 samples per texel in frames that turn with azimuth.
            np.testing.assert_allclose(found, np.broadcast_to(found[:, :1], found.shape), atol=0.02)
            assert found[0].min() > 0.6 and found[-1].max() < 0.3


def test_maps_are_made_once_and_only_when_needed(light):
    maps = Precomputed(light(1.0))
    assert set(maps.maps) == {"radiance_map"}
    maps.need(("prefiltered_ggx",))
    assert set(maps.maps) == {"radiance_map", "prefiltered_ggx"}
    first = maps.maps["prefiltered_ggx"]
    maps.need(("prefiltered_ggx", "prefiltered_beckmann"))
    assert maps.maps["prefiltered_ggx"] is first
    ways = {("radiance_map",), ("prefiltered_ggx",), ("prefiltered_beckmann",)}
    assert set(maps.seconds) == ways
    assert maps.cost(("prefiltered_ggx",)) == sum(
        maps.seconds[made] for made in (("radiance_map",), ("prefiltered_ggx",))
    )


def test_a_lobe_is_the_same_made_alone_or_beside_the_other(light):
    sky = np.random.default_rng(0).uniform(0.5, 1.5, (32, 64, 3))
    base = make(light(sky))
    both = prefilter.make(base, prefilter.LOBES)
    for name in prefilter.LOBES:
        (alone,) = prefilter.make(base, (name,)).values()
        for level in range(prefilter.LEVELS):
            np.testing.assert_allclose(texels(alone, level), texels(both[name], level), rtol=1e-6)


def test_tables_serve_every_environment(light):
    first, second = Precomputed(light(1.0)), Precomputed(light(2.0))
    for maps in (first, second):
        maps.need(("table_ggx",))
    assert first.maps["table_ggx"] is second.maps["table_ggx"]
