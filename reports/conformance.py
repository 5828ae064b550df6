"""What the renderer's maps, tables and samples are by definition, in double precision.

The gate's figures hold a technique against the truth, and the split sum is wrong there by design: a
mistake of some percent would hide behind that. So what it precomputes is held against the integral
that it stands for, by quadrature, and how it puts them together against the formula.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from reports.stability import oracle
from scenes.schema import Material

LEAST_ROWS = 128  # of a quadrature over the sphere: finer than the narrowest lobe that is filtered


@dataclass(frozen=True)
class Conformance:
    """The worst difference of one kind between the renderer and a definition.

    Attributes:
        name: what was checked.
        off: the difference, in the unit of `allowed`; NaN fails.
        allowed: what it may be; reports/run/conformance.py gives the reasons.
        place: where it is found.
    """

    name: str
    off: float
    allowed: float
    place: str

    @property
    def passed(self) -> bool:
        """Whether it is within what is allowed."""
        return self.off <= self.allowed


def direction(uv: np.ndarray, turn: float = 0.0) -> np.ndarray:
    """World directions (n, 3) of places in a lat-long map, (n, 2): see scenes/FORMAT.md."""
    phi, theta = 2 * np.pi * (uv[:, 0] - turn), np.pi * uv[:, 1]
    return np.stack([np.sin(phi) * np.sin(theta), np.cos(phi) * np.sin(theta), np.cos(theta)], 1)


def latlong(world: np.ndarray, turn: float = 0.0) -> np.ndarray:
    """Places (n, 2) of world directions (n, 3) in a turned lat-long map; u is not wrapped."""
    return oracle.latlong(world) + np.array([turn, 0.0])


def bilinear(texels: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """A texture (H, W, C) at (n, 2): columns wrap, rows clamp, texel centres at (i + .5) / size."""
    height, width = texels.shape[:2]
    x, y = uv[:, 0] * width - 0.5, np.clip(uv[:, 1] * height - 0.5, 0, height - 1)
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    right, across = (x - left)[:, None], (y - top)[:, None]
    low = np.minimum(top + 1, height - 1)
    one, two = (
        texels[row, left % width] * (1 - right) + texels[row, (left + 1) % width] * right
        for row in (top, low)
    )
    return one * (1 - across) + two * across


def clamped(texels: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """The same where columns clamp too, as in a table."""
    half = 0.5 / texels.shape[1]
    return bilinear(texels, np.stack([np.clip(uv[:, 0], half, 1 - half), uv[:, 1]], 1))


def trilinear(levels: list[np.ndarray], uv: np.ndarray, lod: np.ndarray | float) -> np.ndarray:
    """The same between levels, each at its own `lod`, (n,) or one for all."""
    lod = np.clip(np.broadcast_to(lod, len(uv)), 0, len(levels) - 1)
    low, each = np.floor(lod).astype(int), np.arange(len(uv))
    high, part = np.minimum(low + 1, len(levels) - 1), (lod - low)[:, None]
    looked = np.stack([bilinear(level, uv) for level in levels])
    return looked[low, each] * (1 - part) + looked[high, each] * part


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
        """The level whose texels are as large as a solid angle, (n,).

        Colbert and Krivanek 2007, eq. 13; nearer to a pole than half a row sin(theta) stays.
        """
        height, width = self.radiance.shape[:2]
        sine = np.maximum(np.hypot(world[:, 0], world[:, 1]), 0.5 / height)
        texel = 2 * np.pi**2 / (width * max(height - 1, 1)) * sine
        return np.maximum(0.5 * np.log2(solid_angle / texel), 0)

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


def lambert(cosine: np.ndarray) -> np.ndarray:
    """The kernel of irradiance."""
    return np.maximum(cosine, 0)


def reflected(lobe: Callable[..., np.ndarray], alpha: float) -> Callable[[np.ndarray], np.ndarray]:
    """The kernel of a prefiltered map: D(h) n.l / 4 for n = v, so that h lies half way to l."""

    def kernel(cosine: np.ndarray) -> np.ndarray:
        flat = np.clip(cosine.ravel(), -1, 1)
        h = np.stack([np.sqrt((1 - flat) / 2), np.zeros_like(flat), np.sqrt((1 + flat) / 2)], 1)
        with np.errstate(divide="ignore", invalid="ignore"):
            values = np.where(flat > 0, lobe(h, alpha) * flat / 4, 0)
        return values.reshape(cosine.shape)

    return kernel


def cumulated(lobe: str, z: np.ndarray, alpha: float) -> np.ndarray:
    """The share of samples nearer to n than the cosine z, (n,): the integral of their density.

    Of D h.z for `ggx` and `beckmann` (Walter et al. 2007, eq. 35 and 28), of cos / pi for `cosine`.
    """
    sin2 = 1 - z**2
    if lobe == "cosine":
        return sin2
    tan2 = sin2 / z**2
    return tan2 / (alpha**2 + tan2) if lobe == "ggx" else -np.expm1(-tan2 / alpha**2)


def scale_bias(
    cosine: float,
    alpha: float,
    weight: tuple[float, float],
    masking: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray],
    points: int = 64,
) -> np.ndarray:
    """The split sum's scale and bias for F0, (2,): Karis 2013, second sum, as an integral.

    Gauss-Legendre in the share of facets that lie nearer to n, uniform in azimuth; each lobe by its
    own facets.

    Args:
        cosine: n.v.
        weight: shares of GGX and Beckmann in D.
        masking: G by wi, wo (n, 3) and wo.h (n,).
    """
    nodes, areas = _gauss_legendre(points)
    share, area = np.repeat((nodes + 1) / 2, points), np.repeat(areas / 2, points) / points
    phi = np.tile(2 * np.pi * (np.arange(points) + 0.5) / points, points)
    wo = np.broadcast_to([np.sqrt(1 - cosine**2), 0.0, cosine], (len(phi), 3))
    total = np.zeros(2)
    for part, lobe in zip(weight, ("ggx", "beckmann"), strict=True):
        if not part:
            continue
        tan2 = alpha**2 * (share / (1 - share) if lobe == "ggx" else -np.log1p(-share))
        z = 1 / np.sqrt(1 + tan2)
        s = z * np.sqrt(tan2)
        h = np.stack([s * np.cos(phi), s * np.sin(phi), z], 1)
        wo_h = (wo * h).sum(axis=1)
        wi = 2 * wo_h[:, None] * h - wo
        seen = (wi[:, 2] > 0) & (wo_h > 0)
        wi, h, wo_h, a = wi[seen], h[seen], wo_h[seen], area[seen]
        value = masking(wi, wo[seen], wo_h) * wo_h / (h[:, 2] * cosine) * a
        fresnel = (1 - wo_h) ** 5
        total += part * np.array([(value * (1 - fresnel)).sum(), (value * fresnel).sum()])
    return total


@cache
def _gauss_legendre(points: int) -> tuple[np.ndarray, np.ndarray]:
    return np.polynomial.legendre.leggauss(points)


def smith(alpha: float, weight: tuple[float, float] = (1, 0)) -> Callable:
    """Separable Smith masking of a mixture, as `scale_bias` takes it."""
    return lambda wi, wo, wo_h: (
        oracle.G1_smith(wi, alpha, weight) * oracle.G1_smith(wo, alpha, weight)
    )


def vcavity(wi: np.ndarray, wo: np.ndarray, _wo_h: np.ndarray) -> np.ndarray:
    """V-cavities, as `scale_bias` takes them."""
    return oracle.G_vcavity(wi, wo)


def split_sum(
    material: Material, cosine: np.ndarray, L: np.ndarray, ab: np.ndarray, E: np.ndarray
) -> np.ndarray:
    """The paper's eq. 6 and 7, (n, 3).

    Args:
        cosine: n.v, (n,).
        L: prefiltered radiance (n, 3).
        ab: scale and bias, (n, 2).
        E: irradiance (n, 3).
    """
    f0, albedo = np.array(material.specular_f0), np.array(material.diffuse_albedo)
    kd = 1 - oracle.F_schlick(f0, cosine)
    return L * (f0 * ab[:, :1] + ab[:, 1:]) + kd * albedo / np.pi * E
