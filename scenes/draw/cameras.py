"""Cameras drawn at random, and how much of each object they see."""

from dataclasses import dataclass

import numpy as np

from scenes.draw.dice import Rng, log_within, one_of, within
from scenes.draw.layout import Body, Plane
from scenes.draw.sphere import UP, direction

RESOLUTIONS = ((384, 384), (432, 324), (480, 300), (512, 288), (336, 420))
ENOUGH = 12_500  # pixels: a judged object covers 10,000, and the estimate is mostly too high
TRIES = 40
CELL = 4  # pixels a side, in which what is seen is estimated
POINTS = 20_000  # on each object


@dataclass(frozen=True)
class Shot:
    """A camera, the picture's size, and the pixels that each object covers, by name."""

    origin: tuple[float, ...]
    target: tuple[float, ...]
    fov: float
    size: tuple[int, int]
    pixels: dict[str, float]


def draw_camera(rng: Rng, bodies: list[Body], planes: list[Plane]) -> Shot:
    """The first of many cameras that sees enough of every body, or the one that comes nearest.

    A wall is seen from its front, within 60 degrees; a floor from above.
    """
    size = one_of(rng, *RESOLUTIONS)
    points = np.concatenate([b.vertices for b in bodies])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    radius = np.linalg.norm(points - middle, axis=1).max()
    marks = [_marks(b) for b in bodies]
    standing = {p.name: p for p in planes}
    wall, best = standing.get("wall"), None
    for _ in range(TRIES):
        fov = log_within(rng, 10, 70)
        fill = within(rng, 0.75, 1.1)
        azimuth = np.radians(within(rng, -180, 180))
        if wall:
            azimuth = azimuth / 3 + np.arctan2(*wall.axes[2][:2])
        lowest = 4 if "floor" in standing else -25
        up = np.radians(lowest + (50 - lowest) * rng.random() ** 2)  # mostly from low down
        towards = direction(azimuth, up)
        away = _distance(points - middle, towards, np.tan(np.radians(fov) / 2) * fill, size)
        origin = np.round(middle + max(away, 1.15 * radius) * towards, 4)
        target = np.round(middle + 0.1 * radius * rng.uniform(-1, 1, 3), 4)
        pixels = seen(origin, target, fov, size, bodies, marks, planes)
        shot = Shot(tuple(map(float, origin)), tuple(map(float, target)), fov, size, pixels)
        least = min(pixels[b.name] for b in bodies)
        if best is None or least > min(best.pixels[b.name] for b in bodies):
            best = shot
        if least >= ENOUGH:
            break
    return best


def _distance(
    points: np.ndarray, towards: np.ndarray, tangent: float, size: tuple[int, int]
) -> float:
    """From how far away points (n, 3) about the picture's middle just fit into it.

    Args:
        towards: the camera's direction from there, a unit vector.
        tangent: of half the angle that they may fill, upright.
    """
    right, down, forward = _axes(-towards)
    wide = np.abs(points @ right) * size[1] / size[0]
    return float((np.maximum(wide, np.abs(points @ down)) / tangent - points @ forward).max())


def _axes(forward: np.ndarray) -> np.ndarray:
    """A camera's right, down and forward as unit rows, (3, 3)."""
    right = np.cross(forward, UP)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(forward, right), forward])


def seen(
    origin: np.ndarray,
    target: np.ndarray,
    fov: float,
    size: tuple[int, int],
    bodies: list[Body],
    marks: list[np.ndarray],
    planes: list[Plane],
) -> dict[str, float]:
    """About how many pixels of each object and plane are seen, by name.

    The nearest of many points on the objects is looked for in each cell of CELL x CELL pixels;
    planes are met by the ray through its middle.
    """
    columns, rows = size[0] // CELL, size[1] // CELL
    right, down, forward = axes = _axes((target - origin) / np.linalg.norm(target - origin))
    tangent = np.tan(np.radians(fov) / 2)
    depth, owner = np.full(rows * columns, np.inf), np.full(rows * columns, -1)
    for number, points in enumerate(marks):
        x, y, z = axes @ (points - origin).T
        column = np.floor((x / z / tangent * size[1] / 2 + size[0] / 2) / CELL).astype(int)
        row = np.floor((y / z / tangent * size[1] / 2 + size[1] / 2) / CELL).astype(int)
        inside = (z > 0) & (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        cell = row[inside] * columns + column[inside]
        nearest = np.full(rows * columns, np.inf)
        np.minimum.at(nearest, cell, z[inside])
        owner[nearest < depth] = number
        depth = np.minimum(depth, nearest)
    across = ((np.arange(columns) + 0.5) * CELL - size[0] / 2) * tangent * 2 / size[1]
    below = ((np.arange(rows) + 0.5) * CELL - size[1] / 2) * tangent * 2 / size[1]
    rays = (forward + below[:, None, None] * down + across[:, None] * right).reshape(-1, 3)
    for number, plane in enumerate(planes, start=len(bodies)):
        normal = plane.axes[2]
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = (plane.position - origin) @ normal / (rays @ normal)
            offset = np.abs((origin + reach[:, None] * rays - plane.position) @ plane.axes[:2].T)
        hit = (reach > 0) & (reach < depth) & (offset <= np.array(plane.size) / 2).all(axis=1)
        owner[hit] = number
        depth[hit] = reach[hit]
    names = [x.name for x in (*bodies, *planes)]
    return {n: float((owner == k).sum() * CELL**2) for k, n in enumerate(names)}


def _marks(body: Body) -> np.ndarray:
    """Points spread evenly over a body's surface, (POINTS, 3)."""
    a, b, c = body.vertices[body.faces].transpose(1, 0, 2)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).cumsum()
    place = np.arange(POINTS) + 0.5
    face = np.minimum(np.searchsorted(area, place / POINTS * area[-1]), len(a) - 1)
    # Roberts 2018, "The unreasonable effectiveness of quasirandom sequences": R2.
    u, v = (place * 0.7548776662466927) % 1, (place * 0.5698402909980532) % 1
    fold = u + v > 1
    u, v = np.where(fold, 1 - u, u)[:, None], np.where(fold, 1 - v, v)[:, None]
    return a[face] + u * (b[face] - a[face]) + v * (c[face] - a[face])
