"""A lat-long map by its definition, and integrals over the sphere of its light."""

from collections.abc import Callable

import numpy as np

from reports.conformance.textures import bilinear
from reports.stability import oracle

LEAST_ROWS = 128  # of a quadrature over the sphere: finer than the narrowest lobe that is filtered


def direction(uv: np.ndarray, turn: float = 0.0) -> np.ndarray:
    """World directions (n, 3) of places in a lat-long map, (n, 2): see scenes/FORMAT.md."""
    phi, theta = 2 * np.pi * (uv[:, 0] - turn), np.pi * uv[:, 1]
    return np.stack([np.sin(phi) * np.sin(theta), np.cos(phi) * np.sin(theta), np.cos(theta)], 1)


def latlong(world: np.ndarray, turn: float = 0.0) -> np.ndarray:
    """Places (n, 2) of world directions (n, 3) in a turned lat-long map; u is not wrapped."""
    return oracle.latlong(world) + np.array([turn, 0.0])


class Light:
    """A lat-long map by its definition: rows aligned to the poles, bilinear in between.

    Args:
        radiance: (H, W, 3).
    """

    def __init__(self, radiance: np.ndarray) -> None:
        self.radiance = radiance.astype(float)
        height, width = radiance.shape[:2]
        finer = -(-LEAST_ROWS // height)
        self._rows, self._columns = (height - 1) * finer + 1, width * finer

    @property
    def cells(self) -> int:
        """Of a quadrature over the sphere."""
        return self._rows * self._columns

    def at(self, world: np.ndarray, turn: float = 0.0) -> np.ndarray:
        """Radiance (n, 3) from world directions (n, 3)."""
        return bilinear(self.radiance, self.place(world, turn))

    def place(self, world: np.ndarray, turn: float = 0.0) -> np.ndarray:
        """Where in the map, (n, 2), a texture unit finds world directions (n, 3)."""
        rows = len(self.radiance)
        uv = latlong(world, turn)
        uv[:, 1] = (uv[:, 1] * (rows - 1) + 0.5) / rows
        return uv

    def level(self, world: np.ndarray, solid_angle: np.ndarray) -> np.ndarray:
        """The level whose texels are as large as a solid angle, (n,)."""
        height, width = self.radiance.shape[:2]
        return oracle.mip_level((width, height), world, solid_angle)

    def convolved(
        self, axes: np.ndarray, kernels: list[Callable[[np.ndarray], np.ndarray]]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Integrals over the sphere of radiance times kernels of the cosine to some axes.

        Args:
            axes: (n, 3) unit directions.

        Returns:
            The integrals (k, n, 3); those of the kernels alone (k, n); those of the square of
            radiance times cosine, times kernel over cosine (k, n, 3), which tell how much samples
            would scatter.
        """
        shape = (len(kernels), len(axes))
        light, alone, squares = np.zeros((*shape, 3)), np.zeros(shape), np.zeros((*shape, 3))
        edges = np.clip((np.arange(self._rows + 1) - 0.5) / (self._rows - 1), 0, 1)
        areas = -np.diff(np.cos(np.pi * edges)) * 2 * np.pi / self._columns
        u = (np.arange(self._columns) + 0.5) / self._columns
        step = max(1, 200_000 // self._columns)
        for start in range(0, self._rows, step):
            rows = np.arange(start, min(start + step, self._rows))
            v = np.repeat(rows / (self._rows - 1), self._columns)
            world = direction(np.stack([np.tile(u, len(rows)), v], 1))
            weight = np.repeat(areas[rows], self._columns)
            radiance = self.at(world)
            power, square = radiance * weight[:, None], radiance**2 * weight[:, None]
            cosine = axes @ world.T
            for k, kernel in enumerate(kernels):
                values = kernel(cosine)
                light[k] += values @ power
                alone[k] += values @ weight
                squares[k] += (values * cosine) @ square
        return light, alone, squares
