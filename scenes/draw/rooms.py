"""Rooms: a box around the eye, with lamps, soft boxes and windows that light its walls."""

from dataclasses import dataclass

import numpy as np

from scenes.draw.dice import Rng, log_within, one_of, within
from scenes.draw.noise import noise
from scenes.draw.sphere import Canvas, blend, colour, step, tint

CEILING = 5  # faces are -x +x -y +y -z +z
WALLS = (0, 1, 2, 3)


@dataclass(frozen=True)
class Panel:
    """A rectangle on a face of the box: its middle, half its size along the face, and light.

    `panes` parts a window by bars; 1 for none.
    """

    face: int
    middle: np.ndarray
    half: np.ndarray
    light: np.ndarray
    panes: int = 1


class Box:
    """A room seen from within.

    Attributes:
        low, high: (3,) its corners around the eye at 0, metres.
        face: (H, W) which side each texel sees, and `points` where, (H, W, 3).
    """

    def __init__(self, rng: Rng, canvas: Canvas) -> None:
        self.high = np.array([within(rng, 1.5, 5), within(rng, 1.5, 5), within(rng, 1.2, 3)])
        self.low = -np.array([within(rng, 1.5, 5), within(rng, 1.5, 5), within(rng, 0.8, 1.6)])
        towards = np.where(canvas.towards == 0, 1e-12, canvas.towards)
        reach = np.where(towards > 0, self.high, self.low) / towards
        axis = reach.argmin(axis=2)
        self.depth = reach.min(axis=2)
        self.points = canvas.towards * self.depth[..., None]
        sign = np.take_along_axis(towards, axis[..., None], 2)[..., 0] > 0
        self.face = 2 * axis + sign
        self.soft = canvas.texel * self.depth

    def normal(self, face: int) -> np.ndarray:
        """Into the room, (3,)."""
        inwards = np.zeros(3)
        inwards[face // 2] = -1 if face % 2 else 1
        return inwards

    def panel(
        self, rng: Rng, face: int, sizes: tuple[float, float], light, panes: int = 1
    ) -> Panel:
        """A panel of a size drawn from a range (as shares of the face) at a place that fits."""
        axes = [a for a in range(3) if a != face // 2]
        extent = (self.high - self.low)[axes]
        half = extent / 2 * np.array([log_within(rng, *sizes) for _ in axes])
        place = self.low[axes] + half + (extent - 2 * half) * rng.random(2)
        middle = np.zeros(3)
        middle[axes] = place
        middle[face // 2] = (self.high if face % 2 else self.low)[face // 2]
        return Panel(face, middle, half, np.asarray(light, float), panes)

    def inside(self, panel: Panel) -> np.ndarray:
        """1 where a texel sees the panel, (H, W)."""
        axes = [a for a in range(3) if a != panel.face // 2]
        offset = self.points[..., axes] - panel.middle[axes]
        shape = 1.0 * (self.face == panel.face)
        for along in range(2):
            away, half = np.abs(offset[..., along]), panel.half[along]
            shape = shape * (1 - step(away, half, self.soft))
            if panel.panes > 1:
                pane = 2 * half / panel.panes
                bar = np.abs((offset[..., along] / pane + (panel.panes % 2) / 2) % 1 - 0.5) * pane
                shape = shape * step(pane / 2 - bar, 0.03, self.soft)
        return shape

    def lit(self, rng: Rng, albedo: np.ndarray, panels: list[Panel], ambient: float) -> np.ndarray:
        """The room in the light of its panels, (H, W, 3), each taken as a disc from afar.

        Args:
            albedo: (6, 3) of its faces.
            ambient: light that has been about the room, as a share of the panels'.
        """
        inwards = np.array([self.normal(f) for f in range(6)])[self.face]
        light = np.zeros_like(self.points)
        for panel in panels:
            to = panel.middle + 0.02 * self.normal(panel.face) - self.points
            square = (to**2).sum(axis=2)
            here = np.clip((to * inwards).sum(axis=2), 0, None)
            there = np.abs(to[..., panel.face // 2])
            area = 4 * panel.half.prod()
            gain = area * here * there / (square * (square + area / np.pi))
            light = light + gain[..., None] * panel.light
        flux = sum(4 * p.half.prod() * p.light for p in panels)
        light = light + ambient * flux / (self.high - self.low).prod() ** (2 / 3)
        grain = np.exp(within(rng, 0.05, 0.3) * noise(rng, self.points, 6, 5, 0.9))
        corner = np.sort(np.minimum(self.points - self.low, self.high - self.points), axis=2)[
            ..., 1
        ]
        grain = grain * (0.5 + 0.5 * step(corner, 0.1, 0.3))  # edges are darker: occlusion
        room = albedo[self.face] / np.pi * light * grain[..., None]
        for face in rng.integers(0, 5, rng.integers(3, 9)):  # doors, shelves, pictures, rugs
            patch = self.panel(rng, int(face), (0.1, 0.6), np.zeros(3))
            paint = colour(rng, 0.8, log_within(rng, 0.1, 2))
            room = blend(room, room * paint, self.inside(patch))
        return room


def studio(rng: Rng, canvas: Canvas) -> np.ndarray:
    """Soft boxes in a dark room."""
    box = Box(rng, canvas)
    white = tint(within(rng, -0.2, 0.2))
    panels = [
        box.panel(rng, int(one_of(rng, *WALLS, CEILING)), (0.08, 0.5), white * w)
        for w in rng.uniform(0.4, 1.6, rng.integers(1, 5))
    ]
    if rng.random() < 0.3:
        gel = colour(rng, 1.0)
        panels[-1] = Panel(panels[-1].face, panels[-1].middle, panels[-1].half, 0.6 * gel)
    albedo = np.array([colour(rng, 0.3, log_within(rng, 0.02, 0.3)) for _ in range(6)])
    return _shown(rng, box, albedo, panels, log_within(rng, 0.05, 0.3))


def lamps(rng: Rng, canvas: Canvas) -> np.ndarray:
    """Many small bright lamps over a furnished room."""
    box = Box(rng, canvas)
    warm = tint(within(rng, 0.0, 0.8))
    faces = [int(one_of(rng, *WALLS, *[CEILING] * 8)) for _ in range(rng.integers(2, 11))]
    light = warm * log_within(rng, 30, 1500)
    panels = [box.panel(rng, f, (0.01, 0.05), light) for f in faces]
    albedo = np.array([colour(rng, 0.4, within(rng, 0.2, 0.8)) for _ in range(6)])
    return _shown(rng, box, albedo, panels, log_within(rng, 0.2, 0.6))


def windows(rng: Rng, canvas: Canvas) -> np.ndarray:
    """Daylight through windows into a dark room."""
    box = Box(rng, canvas)
    day = tint(within(rng, -0.6, 0.3)) * within(rng, 4, 20)
    faces = rng.permutation(4)[: rng.integers(1, 4)]
    panels = [
        box.panel(rng, int(face), (0.2, 0.7), day, int(rng.integers(1, 5)))
        for face in faces
        for _ in range(rng.integers(1, 3))
    ]
    albedo = np.array([colour(rng, 0.4, log_within(rng, 0.06, 0.6)) for _ in range(6)])
    view = np.exp(0.5 * noise(rng, canvas.towards, 5, 5, 0.6))
    view = view * (0.15 + 0.85 * step(canvas.towards[..., 2] + 0.03 * view, 0.0, 0.1))
    return _shown(rng, box, albedo, panels, log_within(rng, 0.1, 0.3), view)


def painted(rng: Rng, canvas: Canvas) -> np.ndarray:
    """Strongly coloured walls under one or two large lights in the ceiling."""
    box = Box(rng, canvas)
    panels = [
        box.panel(rng, CEILING, (0.15, 0.5), tint(within(rng, 0, 0.4)) * 8)
        for _ in range(rng.integers(1, 3))
    ]
    albedo = np.array([0.05 + colour(rng, 1.0, within(rng, 0.3, 0.8)) for _ in range(6)])
    albedo[CEILING] = 0.8
    return _shown(rng, box, np.clip(albedo, 0, 0.9), panels, within(rng, 0.3, 0.6))


def _shown(
    rng: Rng,
    box: Box,
    albedo: np.ndarray,
    panels: list[Panel],
    ambient: float,
    view: np.ndarray | float = 1.0,
) -> np.ndarray:
    """The room with its panels themselves; `view` (H, W) is what is seen through them."""
    room = box.lit(rng, albedo, panels, ambient)
    for panel in panels:
        bright = np.broadcast_to(view, box.face.shape)[..., None] * panel.light
        room = blend(room, bright, box.inside(panel))
    return room
