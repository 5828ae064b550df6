"""Objects set side by side so that none cuts another, on a floor, by a wall, or in the air."""

from dataclasses import dataclass, replace

import numpy as np
import trimesh

from scenes.draw.dice import Rng, within
from scenes.draw.sphere import direction

Vector = tuple[float, float, float]
DIGITS = 4  # after the point, of what is written
SETTINGS = ("air", "air", "air", "floor", "floor", "floor", "wall", "corner")
TRIES = 12  # places beside others, of which the one nearest to all is taken
GROUNDED, WALLED = ("floor", "corner"), ("wall", "corner")


@dataclass(frozen=True)
class Body:
    """A mesh where it stands.

    Attributes:
        vertices: (n, 3) in world space; `faces` (m, 3).
        middle, radius: of the upright cylinder that holds it, (3,) and world units.
        rotate, scale, position: as the scene's file has them.
    """

    name: str
    vertices: np.ndarray
    faces: np.ndarray
    middle: np.ndarray
    radius: float
    rotate: Vector
    scale: Vector
    position: Vector


@dataclass(frozen=True)
class Plane:
    """The primitive `plane` where it stands, (width, height) in `size`."""

    name: str
    position: Vector
    rotate: Vector
    size: tuple[float, float]

    @property
    def axes(self) -> np.ndarray:
        """Its unit axes in world space, (3, 3), the normal last."""
        return turned(self.rotate).T


def turned(rotate: Vector) -> np.ndarray:
    """The rotation (3, 3) of an object, as `scenes.mesh.placement` makes it."""
    return trimesh.transformations.euler_matrix(*np.radians(rotate), axes="sxyz")[:3, :3]


def standing(rng: Rng, bodies: list[Body], setting: str) -> list[Plane]:
    """The floor below the bodies and the wall behind them, as far as the setting has them."""
    points = np.concatenate([b.vertices for b in bodies])
    low, high = points.min(axis=0), points.max(axis=0)
    middle, radius = (low + high) / 2, float(np.linalg.norm((high - low)[:2]) / 2)
    planes = []
    if setting in GROUNDED:
        side = round(radius * within(rng, 5, 16), DIGITS)
        place = (*(round(float(m), DIGITS) for m in middle[:2]), 0.0)
        planes.append(Plane("floor", place, (0.0, 0.0, 0.0), (side, side)))
    if setting in WALLED:
        rotate = (90.0, 0.0, within(rng, -180, 180))
        tall = max(2 * radius, high[2] - low[2]) * within(rng, 1, 2)
        size = (round(radius * within(rng, 3, 8), DIGITS), round(float(tall), DIGITS))
        place = middle - turned(rotate)[:, 2] * radius * within(rng, 1.05, 2)
        place[2] = size[1] / 2 if setting in GROUNDED else middle[2]
        place = tuple(round(float(p), DIGITS) for p in place)
        planes.append(Plane("wall", place, rotate, size))
    return planes


def pose(rng: Rng, name: str, mesh: trimesh.Trimesh, grounded: bool) -> Body:
    """A mesh turned and sized, with its middle on the origin.

    Args:
        grounded: mostly as it stands by itself, since something is below it.
    """
    upright = grounded and (name.startswith("bowl") or rng.random() < 0.6)
    tilt = (0.0, 0.0) if upright else (within(rng, -180, 180), within(rng, -90, 90))
    rotate = (*tilt, within(rng, -180, 180))
    size = within(rng, 0.6, 1.0)
    stretch = [1.0, 1.0, 1.0]
    if rng.random() < 0.25:
        stretch = [within(rng, 0.6, 1.4) for _ in range(3)]
    scale = tuple(round(size * s, DIGITS) for s in stretch)
    vertices = np.asarray(mesh.vertices, float) @ (turned(rotate) * scale).T
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    radius = float(np.linalg.norm((vertices - middle)[:, :2], axis=1).max())
    nowhere = (0.0, 0.0, 0.0)
    body = Body(name, vertices, mesh.faces, middle, radius, rotate, scale, nowhere)
    return _moved(body, -middle)


def arranged(rng: Rng, bodies: list[Body], grounded: bool) -> list[Body]:
    """The bodies beside one another, each with a gap to all others.

    Each keeps within its own upright cylinder and no two cylinders meet, so none can cut another.
    With `grounded` each rests on z = 0; else they hang at different heights.
    """
    placed: list[Body] = []
    for body in bodies:
        lift = -body.vertices[:, 2].min() if grounded else within(rng, -0.4, 0.4)
        if grounded and rng.random() < 0.15:
            lift += within(rng, 0.05, 0.5)  # hung above the floor
        body = _moved(body, np.array([0, 0, lift]))
        if placed:
            found: list[Body] = []
            while not found:
                found = [b for b in (_beside(rng, body, placed) for _ in range(TRIES)) if b]
            middle = np.mean([b.middle for b in placed], axis=0)
            body = min(found, key=lambda b: np.hypot(*(b.middle - middle)[:2]))
        placed.append(body)
    return placed


def _beside(rng: Rng, body: Body, placed: list[Body]) -> Body | None:
    """The body moved beside one that stands already; None if another is in the way."""
    near = placed[rng.integers(len(placed))]
    reach = near.radius + body.radius + within(rng, 0.02, 0.4)
    there = near.middle + reach * direction(rng.uniform(0, 2 * np.pi), 0)
    moved = _moved(body, (there - body.middle) * (1, 1, 0))
    return moved if all(_apart(moved, other) for other in placed) else None


def _moved(body: Body, by: np.ndarray) -> Body:
    """The body elsewhere; its position is rounded up, so that it stays above its floor."""
    position = np.ceil((np.array(body.position) + by) * 10**DIGITS) / 10**DIGITS
    shift = position - np.array(body.position)
    vertices, middle = body.vertices + shift, body.middle + shift
    return replace(body, vertices=vertices, middle=middle, position=tuple(map(float, position)))


def _apart(a: Body, b: Body) -> bool:
    """Whether two bodies' cylinders have a gap."""
    return bool(np.hypot(*(a.middle - b.middle)[:2]) > a.radius + b.radius + 0.01)
