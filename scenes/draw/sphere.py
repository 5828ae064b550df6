"""What environments are painted with: directions, solid angles, discs and colours."""

import colorsys

import numpy as np

from scenes.draw.dice import Rng

UP = np.array([0.0, 0.0, 1.0])


class Canvas:
    """A lat-long map to be painted, in the layout of `scenes.environment.RadianceMap`.

    Attributes:
        towards: (H, W, 3), the unit direction of each texel.
        share: (H, W), each texel's share of the sphere.
        texel: the angle between two rows, radians.
    """

    def __init__(self, width: int, height: int) -> None:
        theta = np.pi * np.arange(height) / (height - 1)
        phi = 2 * np.pi * (np.arange(width) + 0.5) / width
        sine = np.sin(theta)[:, None]
        z = np.broadcast_to(np.cos(theta)[:, None], (height, width))
        self.towards = np.stack([sine * np.sin(phi), sine * np.cos(phi), z], axis=2)
        weight = np.broadcast_to(sine, (height, width))
        self.share = weight / weight.sum()
        self.texel = np.pi / (height - 1)

    def mean(self, radiance: np.ndarray) -> np.ndarray:
        """The mean over the sphere of (H, W, 3), (3,)."""
        return (self.share[..., None] * radiance).sum(axis=(0, 1))

    def angle(self, axis: np.ndarray) -> np.ndarray:
        """The angle of each texel from a unit direction, (H, W) radians."""
        chord = np.linalg.norm(self.towards - axis, axis=2)
        return 2 * np.arcsin(np.clip(chord / 2, 0, 1))

    def disc(self, axis: np.ndarray, radius: float) -> np.ndarray:
        """1 inside a disc of angular `radius`, 0 outside, over a soft edge of two texels; (H, W).

        No smaller than a texel, or it might fall between them.
        """
        return 1 - step(self.angle(axis), max(radius, self.texel), self.texel)

    def lit(self, radiance: np.ndarray, lamp: np.ndarray, share: float, colour: np.ndarray):
        """Radiance (H, W, 3) with a lamp of shape (H, W) that gives a share of all light."""
        flux = (self.share * lamp).sum()
        level = self.mean(radiance).mean() * share / (1 - share) / (flux * colour.mean())
        return radiance + level * lamp[..., None] * colour


def step(numbers: np.ndarray, edge: float | np.ndarray, soft: float | np.ndarray) -> np.ndarray:
    """From 0 to 1 over `edge` - `soft` to `edge` + `soft`, smoothly."""
    t = np.clip((numbers - edge) / (2 * soft) + 0.5, 0, 1)
    return t * t * (3 - 2 * t)


def blend(a: np.ndarray, b: np.ndarray, share: np.ndarray) -> np.ndarray:
    """a (..., 3) where the share (H, W) is 0, b where it is 1."""
    return a + (b - a) * share[..., None]


def direction(azimuth: float, elevation: float) -> np.ndarray:
    """A unit direction (3,) from radians."""
    flat = np.cos(elevation)
    return np.array([flat * np.sin(azimuth), flat * np.cos(azimuth), np.sin(elevation)])


def colour(rng: Rng, saturation: float, value: float = 1.0) -> np.ndarray:
    """A colour of any hue and up to some saturation, linear RGB (3,)."""
    return np.array(colorsys.hsv_to_rgb(rng.random(), saturation * rng.random(), value))


def tint(warmth: float) -> np.ndarray:
    """White light that is warm (1) to cool (-1), linear RGB (3,)."""
    return np.array([1 + 0.45 * warmth, 1.0, 1 - 0.55 * warmth])
