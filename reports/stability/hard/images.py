"""Hard pictures, and what must hold of every picture."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

from reports.stability.hard.case import DENSE, SAME, Draw, Expect, Hard, Make, Part, twin
from reports.stability.hard.inputs import (
    BALLS,
    COPPER,
    MIRROR,
    PLASTIC,
    lit,
    lump,
    sky,
    under_sky,
    write_map,
    write_ply,
)
from scenes.schema import Camera, Case

SIZES = ((1, 1), (1, 37), (37, 1), (7, 13), (16384, 1), (1, 16384))
PARTS = ((0, 0, 23, 32), (23, 0, 25, 32))  # halves that are not quite: left, bottom, width, height
SINGLE = tuple((x, 0, 1, 1) for x in range(12))
# Mesa rounds interpolated normals by where the framebuffer's corner is.
ROUNDED = dict.fromkeys(SAME, 2e-5)
# A pixel's coverage samples do not lie in mirror symmetry, and where an object hides a part of
# itself they show; nor do directions, which leave their noise.
MIRRORED = {"paper": 0.02, "paper-noaa": 1e-3, DENSE: 0.03}
TURNED = {"paper": 1e-5, "paper-noaa": 1e-5, DENSE: 0.005}  # directions turn about the normal


def scene(folder: Path, mirrored: bool = False, turn: float = 0.0) -> Case:
    """Three things without symmetry; all mirrored in x, or all turned about z by degrees."""
    vertices, faces = lump()
    side = -1.0 if mirrored else 1.0
    path = write_ply(folder, vertices * [side, 1, 1], faces[:, :: int(side)])

    def at(x: float, y: float, z: float) -> tuple[float, float, float]:
        x, c, s = side * x, np.cos(np.radians(turn)), np.sin(np.radians(turn))
        return (float(c * x - s * y), float(s * x + c * y), z)

    turned = {"rotate": (0.0, 0.0, turn)}
    things = (
        (path, PLASTIC, {"position": at(0.6, 0.3, 0.0), **turned}),
        ("sphere", COPPER, {"position": at(-0.7, 0.0, 0.3), "scale": 0.6, **turned}),
        ("plane", COPPER, {"position": at(0.0, 0.0, -0.8), "scale": 3.0, **turned}),
    )
    camera = Camera(origin=at(0.5, -4.0, 0.7), target=at(0.0, 0.0, 0.0), fov=40)
    # Azimuths run from y to x, against the turn.
    return lit(sky(folder, mirrored=mirrored), *things, camera=camera, rotation=turn)


def in_parts(make: Make, parts: tuple[Part, ...]) -> Expect:
    """Expect the picture that comes of drawing columns of it apart."""

    def expect(draw: Draw, folder: Path) -> np.ndarray:
        return np.concatenate([draw(make(folder), part).rgb for part in parts], axis=1)

    return expect


def sun_in_a_mirror(folder: Path, radiance: float = 1e7) -> Case:
    """A mirror ball that shows a sun."""
    pixels = np.zeros((16, 32, 3))
    pixels[6, 16] = radiance
    path = write_map(folder, pixels)
    return lit(path, ("sphere", MIRROR, {"scale": 0.9}))


def rows() -> Iterator[Hard]:
    row = partial(Hard, kind="image")
    balls = under_sky(*BALLS)
    for size in SIZES:
        yield row(
            name=f"{size[0]}x{size[1]}-pixels",
            must_hold="it is drawn, no pixel NaN, Inf or negative",
            why="quads, crops and derivatives have no neighbour there",
            case=under_sky(*BALLS, size=size),
            silhouette=0.02 if min(size) > 1 else None,
        )
    yield row(
        name="sun-in-a-mirror",
        must_hold="a reflection beyond 65,504 survives, and is that of a sun of 1",
        why="in a target of half floats it would be Inf, or clipped",
        case=sun_in_a_mirror,
        expect=twin(partial(sun_in_a_mirror, radiance=1.0), lambda rgb: 1e7 * rgb.astype(float)),
        brightest=65504.0 * 2,
    )
    yield row(
        name="drawn-twice",
        must_hold="both pictures are the same, bit by bit",
        why="a random number, a race or memory that was never written would show",
        case=balls,
        expect=twin(balls),
        within=dict.fromkeys(SAME, 0.0),
    )
    yield row(
        name="split-frame",
        must_hold="two parts side by side are the picture",
        why="what depends on the framebuffer is no property of the scene: jitter, crops, "
        "interpolation",
        case=scene,
        expect=in_parts(scene, PARTS),
        within=ROUNDED,
    )
    yield row(
        name="one-pixel-parts",
        must_hold="each pixel drawn alone is that of the picture",
        why="as for the halves, and every part is mostly outside of what objects cover",
        case=partial(scene_of_size, size=(12, 1)),
        expect=in_parts(partial(scene_of_size, size=(12, 1)), SINGLE),
        within=ROUNDED,
    )
    yield row(
        name="mirrored-scene",
        must_hold="the picture is mirrored",
        why="a wrong handedness, azimuth or offset of half a texel shows as a shift",
        case=scene,
        expect=twin(partial(scene, mirrored=True), lambda rgb: rgb[:, ::-1]),
        within=MIRRORED,
        interior=True,
    )
    yield row(
        name="everything-turned",
        must_hold="turning camera, objects and environment together changes nothing",
        why="only relative directions count",
        case=scene,
        expect=twin(partial(scene, turn=37.0)),
        within=TURNED,
        interior=True,
    )


def scene_of_size(folder: Path, size: tuple[int, int]) -> Case:
    """The three things in a picture of another size."""
    return scene(folder).model_copy(update={"width": size[0], "height": size[1]})
