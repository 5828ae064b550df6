"""One point evaluated by every side."""

from collections.abc import Iterator

import numpy as np

from reports.run.stability.furnaces import furnaces
from reports.run.stability.geometry import level, split_sum
from reports.run.stability.sides import exact, mitsuba, shader
from reports.stability.agreement import off_by
from reports.stability.points import Point

Told = tuple[str, np.ndarray]  # what, and its numbers


def evaluate(point: Point) -> list[Told]:
    """What GLSL, float64 and Mitsuba make of a point, and how far apart they are."""
    sides = dict(_sides(point))
    told = list(sides.items())
    if "float64" not in sides:
        return told
    ours, truth = sides["GLSL"].astype(float), sides["float64"]
    told.append(("difference", np.abs(ours - truth)))
    peak, words = 0.0, "over |float64|"
    if point.name == "brdf":
        mirrored = point.inputs | {"wi": point.inputs["wo"] * np.float32([-1, -1, 1])}
        peak = np.abs(exact("brdf", mirrored, point.masking)[0])
        words = "over max(|f|, 1e-4 of it at h = n)"
    told.append((words, off_by(ours, truth, peak)))
    return told


def _sides(point: Point) -> Iterator[Told]:
    given = point.inputs
    weight = float(given["weight"][0]) if "weight" in given else 1.0
    if point.name in ("normalised", "weak_furnace", "white_furnace"):
        alpha, cosine = (np.ravel(given.get(n, 1.0)) for n in ("alpha", "n.v"))
        yield "GLSL", furnaces(alpha, cosine, weight, point.masking)[point.name][0]
    elif point.name == "scale_bias":
        place = given["n.v"].item(), given["roughness"].item()
        found = split_sum(*place, weight, point.masking)
        yield from zip(("GLSL", "float64"), found, strict=True)
    elif point.name == "radiance_lod":
        found = level(given["size"], given["w"][None], np.ravel(given["density"]))
        yield from zip(("GLSL", "float64"), found, strict=True)
    else:
        yield "GLSL", shader(point.name, given, point.masking)[0]
        yield "float64", exact(point.name, given, point.masking)[0]
        if point.name == "brdf":
            yield "Mitsuba", mitsuba(given, point.masking)[0]
