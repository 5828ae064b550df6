"""Open skies: a gradient, a sun, clouds, and what stands on the ground below."""

import colorsys

import numpy as np

from scenes.draw.dice import Rng, log_within, within
from scenes.draw.noise import noise
from scenes.draw.sphere import Canvas, blend, colour, direction, step, tint


def clear_sky(rng: Rng, canvas: Canvas) -> np.ndarray:
    """A blue sky with a sun of any height."""
    sun = direction(rng.uniform(0, 2 * np.pi), np.radians(within(rng, 12, 75)))
    sky = _gradient(rng, canvas, tint(-0.2), tint(-1) * np.array([0.5, 0.75, 1.0]))
    sky = _glow(rng, canvas, sky, sun, tint(0.3))
    whole = _land(rng, canvas, sky, sun)
    size = np.radians(log_within(rng, 0.3, 1.5))
    return canvas.lit(whole, canvas.disc(sun, size), within(rng, 0.15, 0.6), tint(0.15))


def clouds(rng: Rng, canvas: Canvas) -> np.ndarray:
    """Clouds, broken to closed, with the sun a bright spot in them or none."""
    sun = direction(rng.uniform(0, 2 * np.pi), np.radians(within(rng, 10, 80)))
    sky = _gradient(rng, canvas, tint(0), tint(-0.8) * np.array([0.5, 0.7, 0.9]))
    cover = _cover(rng, canvas, within(rng, -0.8, 0.8))
    lining = 1 + 2.5 * np.exp(-canvas.angle(sun) / within(rng, 0.2, 0.6))
    bright = lining * within(rng, 0.8, 2.0) * np.exp(-0.4 * cover)
    sky = blend(sky, bright[..., None] * tint(within(rng, -0.2, 0.2)), step(cover, 0.3, 0.3))
    whole = _land(rng, canvas, sky, sun)
    veiled = canvas.disc(sun, np.radians(log_within(rng, 1, 8)))
    return canvas.lit(whole, veiled * (canvas.towards[..., 2] > 0), within(rng, 0.01, 0.2), tint(0))


def dusk(rng: Rng, canvas: Canvas) -> np.ndarray:
    """A low sun in a warm band above the horizon, under a cool sky."""
    sun = direction(rng.uniform(0, 2 * np.pi), np.radians(within(rng, 1, 12)))
    sky = _gradient(rng, canvas, tint(0.5), tint(-0.9) * np.array([0.35, 0.5, 0.8]))
    near = np.exp(-canvas.angle(sun) / within(rng, 0.4, 1.0))
    band = np.exp(-np.abs(canvas.towards[..., 2]) / within(rng, 0.08, 0.3))
    sky = sky + (3 * near * band)[..., None] * np.array([1.0, 0.45, 0.15])
    streaks = _cover(rng, canvas, within(rng, -0.9, 0.2))
    under = (0.4 + 3 * near)[..., None] * np.array([0.9, 0.6, 0.55])
    sky = blend(sky, under, 0.8 * step(streaks, 0.3, 0.4))
    whole = _land(rng, canvas, sky, sun)
    size = np.radians(log_within(rng, 0.4, 4))
    return canvas.lit(whole, canvas.disc(sun, size), within(rng, 0.02, 0.45), tint(0.8))


def forest(rng: Rng, canvas: Canvas) -> np.ndarray:
    """Leaves and trunks, with the sky through holes of every size between them."""
    height = canvas.towards[..., 2]
    leaves = np.exp(within(rng, 0.6, 1.2) * noise(rng, canvas.towards, 3, 6, 0.75))
    green = blend(
        np.array([0.12, 0.16, 0.05]),
        np.array([0.3, 0.35, 0.1]),
        step(noise(rng, canvas.towards, 2, 3), 0, 1.5),
    )
    floor = np.array([0.2, 0.15, 0.09]) * within(rng, 0.3, 2)
    scene = leaves[..., None] * blend(green, floor, step(-height, 0.05, 0.08))
    azimuth = canvas.towards * np.array([1, 1, 0.04])  # stretched upright: trunks
    trunks = step(noise(rng, azimuth, log_within(rng, 4, 10), 3), 1.1, 0.25) * (
        np.abs(height) < 0.7
    )
    scene = blend(scene, 0.35 * scene[..., :1] * np.array([1.0, 0.8, 0.6]), trunks)
    holes = noise(rng, canvas.towards, log_within(rng, 3, 8), 5, 0.7) + 1.4 * height
    open_sky = step(holes, within(rng, 1.2, 2.4), 0.25) * (height > -0.05)
    return blend(scene, within(rng, 2, 12) * tint(within(rng, -0.5, 0.1)), open_sky)


def _gradient(rng: Rng, canvas: Canvas, horizon: np.ndarray, zenith: np.ndarray) -> np.ndarray:
    """A sky that goes from one colour to the other, (H, W, 3)."""
    up = np.clip(canvas.towards[..., 2], 0, 1) ** within(rng, 0.3, 0.8)
    return blend(horizon * within(rng, 0.7, 1.4), zenith * within(rng, 0.4, 1.0), up)


def _glow(rng: Rng, canvas: Canvas, sky: np.ndarray, sun: np.ndarray, light: np.ndarray):
    """The haze around a sun, falling off over some degrees."""
    haze = within(rng, 0.5, 5) * np.exp(-canvas.angle(sun) / within(rng, 0.05, 0.4))
    return sky + haze[..., None] * light


def _cover(rng: Rng, canvas: Canvas, bias: float) -> np.ndarray:
    """Clouds on a flat ceiling seen from below, (H, W): over 0 there is cloud."""
    x, y, z = np.moveaxis(canvas.towards, 2, 0)
    reach = np.clip(z, 0, 1) + 0.12  # the earth is round: no detail without end at the horizon
    ceiling = np.stack([x / reach, y / reach, np.zeros_like(x)], axis=2)
    return noise(rng, ceiling, log_within(rng, 0.4, 1.5), 6, 0.55) + bias


def _land(rng: Rng, canvas: Canvas, sky: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """Ground below the sky and a skyline between them, both in that sky's own light."""
    height = canvas.towards[..., 2]
    ambient = canvas.mean(sky * (height > 0)[..., None]) * 2
    earth = blend(_earth(rng), _earth(rng), _patches(rng, canvas))
    grain = np.exp(within(rng, 0.1, 0.4) * noise(rng, canvas.towards, 8, 4, 0.8))
    ground = earth * ambient * (1 + np.clip(sun[2], 0, 1)) * grain[..., None]
    whole = blend(ground, sky, step(height, 0, canvas.texel))
    flat = canvas.towards * np.array([1, 1, 0])
    around = flat / np.maximum(np.linalg.norm(flat, axis=2), 1e-9)[..., None]
    rise = noise(rng, around, log_within(rng, 1, 6), 5, within(rng, 0.4, 0.7))
    if rng.random() < 0.5:  # roofs are flat
        rise = np.round(rise * 2) / 2
    line = within(rng, 0.0, 0.1) + within(rng, 0.01, 0.12) * rise
    far = colour(rng, 0.5, within(rng, 0.05, 0.35)) * ambient * grain[..., None]
    standing = step(line - height, 0, canvas.texel) * (height > -0.02)
    return blend(whole, far, standing)


def _earth(rng: Rng) -> np.ndarray:
    """Stone, sand, soil, grass or snow, linear RGB (3,)."""
    hue, saturation = rng.uniform(0.05, 0.33), rng.uniform(0, 0.6)
    return np.array(colorsys.hsv_to_rgb(hue, saturation, log_within(rng, 0.06, 0.6)))


def _patches(rng: Rng, canvas: Canvas) -> np.ndarray:
    """Where the ground is of its second kind, (H, W): fields, paths, puddles of shadow."""
    x, y, z = np.moveaxis(canvas.towards, 2, 0)
    depth = np.maximum(-z, 0.03)
    flat = np.stack([x / depth, y / depth, np.zeros_like(x)], axis=2)
    return step(noise(rng, flat, log_within(rng, 0.3, 2), 4), 0, 1)
