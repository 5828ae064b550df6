"""A point to evaluate again, as a user gives it: `brdf alpha=.01 wi=0,0,1 wo=.6,0,.8`."""

import math
from dataclasses import dataclass, field
from typing import get_args

import numpy as np

from reports.stability.directions import MASKINGS
from reports.stability.functions import DIRECTIONS, FUNCTIONS, PARTS, Inputs
from scenes.errors import InputError
from scenes.schema import Model
from scenes.words import nearest

WHERE = "--at"
DEFAULTS = {
    "weight": (1.0, 0.0),
    "albedo": (0.0, 0.0, 0.0),
    "f0": (1.0, 1.0, 1.0),
    "count": (1.0, 1.0, 1.0),
}
# Not one call of a function: what is integrated, or looked up.
INTEGRALS = {
    "normalised": ("alpha", "weight"),
    "weak_furnace": ("alpha", "n.v", "weight", "masking"),
    "white_furnace": ("alpha", "n.v", "weight", "masking"),
    "scale_bias": ("n.v", "roughness", "weight", "masking"),
    "radiance_lod": ("size", "w", "density"),
    "model": (
        "alpha",
        "weight",
        "metallic",
        "wi",
        "wo",
        "fresnel",
        "kd",
        "masking",
        "multiscatter",
    ),
}
# Inputs that are words, and what each may be; the first is the default.
WORDS = {
    "masking": MASKINGS,
    **{n: get_args(Model.model_fields[n].annotation) for n in ("fresnel", "kd", "multiscatter")},
}
_PARTS = PARTS | {"n.v": 1, "roughness": 1, "metallic": 1, "size": 2, "density": 1}
_ABOVE_0 = ("alpha", "n.v", "roughness")
_WHOLE = ("index", "points", "count", "size")


@dataclass(frozen=True)
class Point:
    """A function and its inputs: (parts,) float32 by name, the masking, and other switches."""

    name: str
    inputs: Inputs
    masking: str = "paper"
    switches: dict[str, str] = field(default_factory=dict)


def point(text: str) -> Point:
    """Read a point.

    Raises:
        InputError: it names no function, or inputs that the function has not or that are no
            numbers of its kind, or gives one twice, or leaves one out.
    """
    name, *given = text.split() or [""]
    known = {n: f.inputs for n, f in FUNCTIONS.items()} | INTEGRALS
    if name not in known:
        remedy = nearest(name, known) + "see `shadeproof stability --list`"
        raise InputError(WHERE, "", f"there is no function '{name}'", remedy)
    takes = taken(name)
    found: dict[str, tuple[float, ...]] = {}
    words, told = {}, set()
    for part in given:
        key, equals, value = part.partition("=")
        if not equals or key not in takes:
            remedy = f"give its inputs as {', '.join(f'{t}=...' for t in takes)}"
            raise InputError(WHERE, name, f"has no input '{key}'", remedy)
        if key in told:
            raise InputError(WHERE, name, f"has {key} twice", "give it once")
        told.add(key)
        if key in WORDS:
            words[key] = _word(name, key, value)
        else:
            found[key] = _numbers(f"{name} {key}", key, value)
    found.setdefault("weight_g", found.get("weight", DEFAULTS["weight"]))
    for key in known[name]:
        if key not in WORDS and key not in found and key not in DEFAULTS:
            raise InputError(WHERE, name, f"lacks its input {key}", f"add {key}=...")
    kept = {k: found.get(k, DEFAULTS.get(k)) for k in known[name] if k not in WORDS}
    masking = words.pop("masking", "paper")
    return Point(name, {k: np.float32(v) for k, v in kept.items()}, masking, words)


def taken(name: str) -> list[str]:
    """The inputs of a function."""
    if name in INTEGRALS:
        return [*INTEGRALS[name]]
    masking = ["masking"] if name in ("brdf", "G_mixture") else []
    return [*FUNCTIONS[name].inputs, *masking]


def _word(name: str, key: str, value: str) -> str:
    if value not in WORDS[key]:
        remedy = f"use {' or '.join(WORDS[key])}"
        raise InputError(WHERE, f"{name} {key}", f"'{value}' is no {key}", remedy)
    return value


def _numbers(where: str, key: str, value: str) -> tuple[float, ...]:
    try:
        numbers = tuple(float(x) for x in value.split(","))
    except ValueError:
        numbers = (math.nan,)
    parts = _PARTS[key]
    if not all(math.isfinite(x) for x in numbers):
        what = "a number" if parts == 1 else f"{parts} numbers, parted by commas"
        raise InputError(WHERE, where, f"'{value}' is no number", f"give {what}")
    if "weight" in key and len(numbers) == 1:
        numbers = (numbers[0], 1 - numbers[0])
    if len(numbers) != parts:
        problem = f"has {len(numbers)} numbers"
        raise InputError(WHERE, where, problem, f"give {parts}, parted by commas")
    if "weight" in key and not all(0 <= x <= 1 for x in numbers):
        problem = f"{value} lies outside of [0, 1]"
        raise InputError(WHERE, where, problem, "give GGX's share, or both shares, within")
    if key in DIRECTIONS:
        numbers = _unit(where, value, numbers)
    if key in _ABOVE_0 and not 0 < numbers[0] <= 1:
        raise InputError(WHERE, where, f"{value} lies outside of (0, 1]", "give one within")
    if key in _WHOLE and not all(x == int(x) and 0 <= x <= 2**24 for x in numbers):
        raise InputError(WHERE, where, f"{value} counts nothing", "give whole numbers up to 2^24")
    if key == "size" and not all(1 <= x <= 16384 for x in numbers):
        raise InputError(WHERE, where, f"{value} is no size", "give two numbers of 1 to 16,384")
    return numbers


def _unit(where: str, value: str, numbers: tuple[float, ...]) -> tuple[float, ...]:
    """A direction; one that is rounded further than to float32 is made a unit vector."""
    length = math.hypot(*numbers)
    if abs(length - 1) > 1e-3:
        problem = f"{value} is {length:.4g} long"
        raise InputError(WHERE, where, problem, "give a direction of length 1")
    return numbers if abs(length - 1) < 1e-6 else tuple(x / length for x in numbers)
