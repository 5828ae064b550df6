"""What both examples need: a command line, the light as others store it, more than 8 bits hold."""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from scenes.environment import load_environment
from scenes.frame import write_exr
from scenes.schema import Case

STOPS = (0, 2, 4, 6, 8, 10)  # of exposures that are joined
FULL = 250  # of 255, from which on a channel may have been cut off


def answer(draw: Callable[[Case], np.ndarray]) -> None:
    """Draw the case of the JSON file that the command line names into the EXR named after it."""
    source, target = map(Path, sys.argv[1:])
    case = Case.model_validate_json(source.read_text(encoding="utf-8"))
    write_exr(target, np.ascontiguousarray(draw(case)), ["R", "G", "B"])


def unturned(case: Case) -> np.ndarray:
    """The case's radiance map (h, w, 3) float32 with its rotation carried out."""
    radiance = load_environment(case.environment.path).radiance
    shift = case.environment.rotation / 360 * radiance.shape[1]
    whole, part = int(np.floor(shift)), shift - np.floor(shift)
    first = np.roll(radiance, -whole, axis=1)
    return ((1 - part) * first + part * np.roll(first, -1, axis=1)).astype(np.float32)


def joined(shoot: Callable[[float], np.ndarray], decode: Callable[[np.ndarray], np.ndarray]):
    """Linear radiance (h, w, 3) float32 from 8-bit pictures at several exposures.

    Args:
        shoot: draws with the light multiplied by a number, (h, w, 3) uint8.
        decode: display values in [0, 1] to linear ones.
    """
    light = None
    for stops in STOPS:
        shot = shoot(2.0**-stops)
        linear = decode(shot / 255) * 2.0**stops
        if light is None:
            light = linear
            full = shot >= FULL
        else:
            light = np.where(full, linear, light)
            full = full & (shot >= FULL)
        if not full.any():
            break
    return light.astype(np.float32)


def averaged(picture: np.ndarray, scale: int) -> np.ndarray:
    """A picture (h, w, 3) averaged over squares of `scale` pixels aside: a box filter."""
    height, width = picture.shape[0] // scale, picture.shape[1] // scale
    return picture.reshape(height, scale, width, scale, 3).mean(axis=(1, 3))
