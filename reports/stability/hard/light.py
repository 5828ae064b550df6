"""Hard environments."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

from reports.furnace import Surface, furnace_albedo
from reports.stability.hard.case import DENSE, SAME, Draw, Hard, Make, twin
from reports.stability.hard.inputs import (
    AHEAD,
    BALLS,
    WHITE,
    constant,
    lit,
    sky,
    write_map,
)
from scenes.schema import Case

ROWS, COLUMNS = 16, 32
FURTHER = COLUMNS // 2  # half a turn: the texels of every level lie on texels again
SUN_AT = (6, 20)
# The prefiltered maps take the same directions about each texel's own frame. A texel stored
# elsewhere has another frame, so that a sun of one texel shows what is left of their noise.
STORED_ELSEWHERE = {"paper": 0.06, "paper-noaa": 0.06, "sampled": 1e-4, "sampled@1": 1e-4}
ROUND = AHEAD.model_copy(update={"origin": (0.0, -100.0, 0.0), "fov": 1.2})  # rays all but parallel
# A map of odd size is constant too, and each level of it.
ODD = ((1, 2), (2, 2), (3, 5), (7, 13), (31, 15), (255, 511))


def balls(make_map) -> Make:
    """The three balls in the light that `make_map` writes into the folder."""
    return lambda folder: lit(make_map(folder), *BALLS)


def _uneven() -> np.ndarray:
    return np.random.default_rng(1).uniform(0.2, 1.0, (ROWS, COLUMNS, 3))


def sun(radiance: float, at: tuple[int, int] = SUN_AT, turned: int = 0) -> Make:
    """One texel as bright as `radiance` in an uneven map whose data is turned by so many columns.

    The environment's rotation makes up for the turn: the light is the same.
    """

    def make(folder: Path) -> Case:
        pixels = _uneven()
        pixels[at] = radiance
        path = write_map(folder, np.roll(pixels, turned, axis=1))
        return lit(path, *BALLS, rotation=360 * turned / COLUMNS)

    return make


def only_sun(radiance: float) -> Make:
    """The same texel alone: every pixel is proportional to it."""

    def make(folder: Path) -> Case:
        pixels = np.zeros((ROWS, COLUMNS, 3))
        pixels[SUN_AT] = radiance
        return lit(write_map(folder, pixels), *BALLS)

    return make


def sunlit(folder: Path) -> Case:
    """The rougher balls in a sun of 1e9."""
    pixels = _uneven()
    pixels[SUN_AT] = 1e9
    return lit(write_map(folder, pixels), *BALLS[1:], size=(96, 64))


def bands(folder: Path, rotation: float) -> Case:
    """Light that depends on height alone, brightest at the poles."""
    pixels = np.repeat(np.linspace(-1, 1, ROWS)[:, None, None] ** 8 * 1e3 + 0.1, COLUMNS, axis=1)
    path = write_map(folder, pixels * [1.0, 0.7, 0.4])
    return lit(path, *BALLS, rotation=rotation)


def column(folder: Path, turned: int = 0) -> Case:
    """A bright meridian; unturned it lies on both sides of the seam."""
    pixels = _uneven()
    pixels[:, [0, -1]] = 50
    path = write_map(folder, np.roll(pixels, turned, axis=1))
    return lit(path, *BALLS, rotation=360 * turned / COLUMNS)


def negatives(folder: Path, clamped: bool = False) -> Case:
    """A map with texels below 0, or the same with 0 in their place."""
    pixels = _uneven() - 0.4
    pixels[3, 4] = -1e30
    pixels = np.maximum(pixels, 0) if clamped else pixels
    return lit(write_map(folder, pixels), *BALLS)


def furnace(folder: Path) -> Case:
    """A white metal alone in constant light of 2."""
    things = (("sphere", WHITE, {}),)
    return lit(constant(folder, 2.0), *things, camera=ROUND, size=(32, 32))


def directional_albedo(_draw: Draw, folder: Path) -> np.ndarray:
    """What the furnace must show: twice the albedo at each pixel's angle, in double precision."""
    case = furnace(folder)
    half = 100 * np.tan(np.radians(case.camera.fov) / 2)
    x = (2 * (np.arange(case.width) + 0.5) / case.width - 1) * half
    sine = np.minimum(np.hypot(x[None, :], x[:, None]), 0.999)
    angles = np.radians(np.linspace(0, 88, 45))
    surface = Surface((WHITE.alpha,) * 2, np.array([WHITE.weight]), "paper")
    albedo = [float(furnace_albedo(surface, a)[0, 0]) for a in angles]
    picture = 2 * np.interp(np.arcsin(sine), angles, albedo)
    return np.repeat(picture[..., None], 3, axis=2)


def rows() -> Iterator[Hard]:
    light = partial(Hard, kind="environment")
    yield light(
        name="furnace",
        must_hold="a white metal shows its directional albedo, from double precision",
        why="in constant light an error of energy shows alone, and a black hole is one",
        case=furnace,
        expect=directional_albedo,
        within={"paper": 0.002, "paper-noaa": 0.002, DENSE: 0.002},
        interior=True,
        between=(0.5, 2.1),
    )
    yield light(
        name="black",
        must_hold="the picture is exactly 0",
        why="no light, no picture; ratios of sums are 0/0 where a map is black",
        case=balls(partial(constant, radiance=0.0)),
        between=(0.0, 0.0),
    )
    for radiance in (1e5, 1e6, 1e9, 1e15):
        yield light(
            name=f"sun-{radiance:g}",
            must_hold="the picture is that of a sun of 1, so many times as bright",
            why="half floats end at 65,504; a map or a target of them would clip the sun",
            case=only_sun(radiance),
            expect=twin(only_sun(1.0), lambda rgb, k=radiance: rgb.astype(float) * k),
            brightest=0.01 * radiance,
        )
    yield light(
        name="sun-1e+09-energy",
        must_hold="the light on the objects is Mitsuba's without occlusion",
        why="both sides read one array of float32, and neither may lose a part of it",
        case=sunlit,
        brightest=65504.0,
        energy={"sampled": 0.02},
    )
    for name, at in (("seam", (6, 0)), ("pole", (0, 9)), ("last-row", (ROWS - 1, COLUMNS - 1))):
        yield light(
            name=f"texel-1e6-{name}",
            must_hold="the picture is that of the same light stored half a turn further on",
            why="filters that stop at the map's edge lose or double a light that lies on it",
            case=sun(1e6, at),
            expect=twin(sun(1e6, at, FURTHER)),
            within=STORED_ELSEWHERE,
        )
    yield light(
        name="bright-column-on-the-seam",
        must_hold="the picture is that of the same light stored half a turn further on",
        why="an interpolation that does not wrap draws a line there",
        case=column,
        expect=twin(partial(column, turned=FURTHER)),
        within=dict.fromkeys(SAME, 2e-3),
    )
    yield light(
        name="bright-poles",
        must_hold="turning light that depends on height alone changes nothing",
        why="at a pole the azimuth is undefined and texels shrink to nothing",
        case=partial(bands, rotation=0.0),
        expect=twin(partial(bands, rotation=123.0)),
        within=STORED_ELSEWHERE | {"paper": 0.01, "paper-noaa": 0.01},
    )
    yield light(
        name="negatives",
        must_hold="the picture is that of the map with 0 for what is below 0",
        why="lossy compression stores small negatives; light is not negative, and both sides read "
        "the one clamped array",
        case=negatives,
        expect=twin(partial(negatives, clamped=True)),
    )
    for size in ODD:
        yield light(
            name=f"constant-{size[1]}x{size[0]}",
            must_hold="the picture is that of a constant map of ordinary size",
            why="levels of odd size lose a row or a column where they halve by two",
            case=balls(partial(constant, radiance=1.5, size=size)),
            expect=twin(balls(partial(constant, radiance=1.5))),
            within=dict.fromkeys(SAME, 2e-4),  # the irradiance map is a sum over the texels
        )
    yield light(
        name="uneven-13x7",
        must_hold="no pixel is much brighter than the light",
        why="odd levels of an uneven map",
        case=balls(lambda f: write_map(f, _uneven()[:7, :13])),
        between=(0.0, 1.5),
    )
    for radiance in (1e-38, 1e-45):
        yield light(
            name=f"constant-{radiance:g}",
            must_hold="the picture is no brighter than the light",
            why="denormals may count as 0, and quotients of them as NaN",
            case=balls(partial(constant, radiance=radiance)),
            between=(0.0, 2 * radiance),
        )
    for radiance in (2e15, 3.4028234e38):
        yield light(
            name=f"texel-{radiance:g}",
            must_hold="it is refused in one line",
            why="sums over the map would leave float32 and come out Inf",
            case=sun(radiance),
            refused="brighter than 1e+15",
        )
    yield light(
        name="1-texel-wide",
        must_hold="it is refused in one line",
        why="a map needs a left and a right to interpolate between",
        case=balls(partial(constant, radiance=1.0, size=(2, 1))),
        refused="give at least 2x1 texels",
    )
    yield light(
        name="light-doubled",
        must_hold="the picture is twice as bright, bit by bit",
        why="light transport is linear; doubling a float loses nothing",
        case=balls(partial(sky, factor=2.0)),
        expect=twin(balls(sky), lambda rgb: 2 * rgb),
        within=dict.fromkeys(SAME, 0.0),
    )
