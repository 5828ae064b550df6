"""Points evaluated again by every side, and judged as the maps judge them."""

import numpy as np

from reports.run.stability import brdf, furnaces, geometry, lookups, models, terms
from reports.run.stability.sides import exact, mitsuba, shader
from reports.stability.agreement import TOLERANCE, off_by
from reports.stability.answers import Answer, Judged
from reports.stability.functions import FUNCTIONS
from reports.stability.grid import ALPHAS, COSINES, JUDGED, PER_CELL, pairs
from reports.stability.points import Point
from scenes.schema import Model

OFF = "|difference| over max(|f|, 1e-4 of the lobe's peak)"
PLAIN = {  # figures that are no shares of a lobe: what they are, and the most that passes
    "tangent_frame": ("largest difference", geometry.ORTHONORMAL),
    "latlong_from_direction": ("radians apart", geometry.ANGLE),
    "hammersley": ("largest difference", terms.POINT),
    "radiance_lod": ("levels apart", lookups.LEVEL),
    "scale_bias": ("largest difference", None),
}


def evaluate(point: Point) -> Answer:
    """What GLSL, float64 and Mitsuba make of a point, and whether they agree."""
    given = point.inputs
    weight = float(given["weight"][0]) if "weight" in given else 1.0
    if point.name in ("normalised", "weak_furnace", "white_furnace"):
        alpha, cosine = (np.ravel(given.get(n, 1.0)) for n in ("alpha", "n.v"))
        found = furnaces.furnaces(alpha, cosine, weight, point.masking)[point.name][0]
        return Answer([("GLSL", found)], [_integral(point, found.item())])
    if point.name == "model":
        return _of_model(point)
    if point.name == "scale_bias":
        place = given["n.v"].item(), given["roughness"].item()
        ours, truth = lookups.split_sum(*place, weight, point.masking)
    elif point.name == "radiance_lod":
        ours, truth = lookups.level(given["size"], given["w"][None], np.ravel(given["density"]))
    else:
        ours, truth = (side(point.name, given, point.masking)[0] for side in (shader, exact))
    ours = ours.astype(float)
    sides = [("GLSL", ours), ("float64", truth), ("difference", np.abs(ours - truth))]
    figures = [_apart(point, ours, truth)]
    if point.name == "brdf":
        theirs = mitsuba(given, point.masking)[0]
        off = off_by(ours, theirs, _peak(point)).max()
        figures.append(Judged(f"from Mitsuba, {OFF}", float(off), _limit(point)))
        sides += [("Mitsuba", theirs), ("difference from it", np.abs(ours - theirs))]
    return Answer(sides, figures)


def _of_model(point: Point) -> Answer:
    """A whole BRDF under a model, by all sides."""
    given, model = point.inputs, Model(masking=point.masking, **point.switches)
    alpha, weight, metallic = (float(given[n].flat[0]) for n in ("alpha", "weight", "metallic"))
    material = models.surface(alpha, weight, metallic)
    ours, truth, theirs = models.evaluated(material, model, given["wi"][None], given["wo"][None])
    _, wi, wo = pairs(np.array([alpha]), given["wo"][2:].astype(float))
    peak = np.abs(models.model_brdf(material, wi, wo, model)).max(axis=0)
    figures = [
        Judged(f"{words}{OFF}", float(off_by(ours, other, peak).max()), limit)
        for words, other, limit in (
            ("", truth, TOLERANCE),
            ("from Mitsuba, ", theirs, models.beside_mitsuba(model)),
        )
    ]
    return Answer([("GLSL", ours[0]), ("float64", truth[0]), ("Mitsuba", theirs[0])], figures)


def step(first: Point, second: Point) -> Answer | None:
    """What a map of steps, or of swapped directions, makes of two points; None for no such two."""
    if first.name != second.name or first.masking != second.masking:
        return None
    a, b = (shader(p.name, p.inputs, p.masking)[0].astype(float) for p in (first, second))
    sides = [("GLSL, the second less the first", b - a)]
    differ = {n for n in first.inputs if not np.array_equal(first.inputs[n], second.inputs[n])}
    if first.name != "brdf" or not differ:
        return Answer(sides)
    if differ == {"wi", "wo"}:
        swapped = np.array_equal(first.inputs["wi"], second.inputs["wo"])
        if not swapped or not np.array_equal(first.inputs["wo"], second.inputs["wi"]):
            return Answer(sides)
        figure = Judged(
            f"reciprocal, {OFF}", float(off_by(b, a, _peak(first)).max()), brdf.RECIPROCAL
        )
    elif differ <= {"weight", "weight_g"}:
        moved = np.abs(second.inputs["weight"] - first.inputs["weight"].astype(float)).min()
        figure = _smooth("weight", brdf.weight_step(a, b, float(moved), _ends(first)))
    elif differ == {"alpha"}:
        ratio = (second.inputs["alpha"] / first.inputs["alpha"]).item() - 1
        figure = _smooth("roughness", brdf.roughness_step(a, b, abs(ratio), _peak(first)))
    else:
        return Answer(sides)
    return Answer(sides, [figure])


def _smooth(what: str, steps: np.ndarray) -> Judged:
    words = f"step in {what}, over the largest that the model allows"
    return Judged(words, float(steps.max()), 1.0)


def _ends(point: Point) -> np.ndarray:
    """The largest f of any pair of lobes."""
    return brdf.largest_end(point.inputs, point.masking)[0]


def _apart(point: Point, ours: np.ndarray, truth: np.ndarray) -> Judged:
    """How far GLSL is from float64, as the function's map measures it."""
    off = np.abs(ours - truth)
    if point.name in PLAIN:
        words, limit = PLAIN[point.name]
        if point.name == "latlong_from_direction":
            off = geometry.away(ours[None], truth[None], point.inputs["w"][None].astype(float))
        elif point.name == "hammersley" and not ((ours >= 0) & (ours < 1)).all():
            off = np.array([np.inf])
        return Judged(words, float(off.max()), limit)
    if point.name.startswith("sample_") and point.name != "sample_density":
        words = "error of n.h and of its sine, relative"
        off = terms.turned(ours[None], truth[None])
    else:
        words, off = OFF, off_by(ours, truth, _peak(point))
    return Judged(words, float(off.max()), _limit(point))


def _limit(point: Point) -> float | None:
    """None where alpha or n.v lies outside of what is promised."""
    place = {"alpha": point.inputs.get("alpha", [])}
    place["n.v"] = point.inputs.get("wo", point.inputs.get("w", []))[2:]
    for name, value in place.items():
        low, high = JUDGED[name]
        if not all(low * (1 - 1e-6) <= x <= high * (1 + 1e-6) for x in value):
            return None
    return TOLERANCE


def _peak(point: Point) -> np.ndarray | float:
    """The lobe's peak: that of the map's cell, or beside the grid where wi mirrors wo."""
    given, masking = point.inputs, point.masking
    if point.name.startswith("D_"):
        return exact(point.name, given | {"h": np.float32([0, 0, 1])}, masking)[0]
    if point.name == "beckmann_over_ggx":
        return 4 / np.e
    if "wo" not in FUNCTIONS[point.name].inputs:
        return 0.0
    alpha = given["alpha"].item() if "alpha" in given else ALPHAS[0]
    near = [
        np.isclose(values, x, rtol=1e-5, atol=0)
        for values, x in ((COSINES, given["wo"][2]), (ALPHAS, alpha))
    ]
    if all(n.any() for n in near):
        start = int(near[0].argmax() * len(ALPHAS) + near[1].argmax()) * PER_CELL
        _, wi, wo = (side[start : start + PER_CELL] for side in pairs())
    else:
        wi, wo = (given["wo"] * np.float32([-1, -1, 1]))[None], given["wo"][None]
    return np.abs(exact(point.name, given | {"wi": wi, "wo": wo}, masking)).max(axis=0)


def _integral(point: Point, value: float) -> Judged:
    """A furnace, held to what its map allows."""
    if point.name == "normalised":
        off = furnaces.NORMALISED
        return Judged("integral of D n.h; 1 is right", value, 1 + off, 1 - off)
    if point.name == "white_furnace":
        place = point.inputs["alpha"].item() * point.inputs["n.v"].item()
        limit = furnaces.WHITE if place >= furnaces.PLACED * (1 - 1e-6) else None
        return Judged("share of uniform light sent back; at most 1", value, limit, 0.0)
    words, off = "visible facets over what should be seen; 1 is right", furnaces.WEAK
    return Judged(words, value, 1 + off if point.masking == "smith" else None, 1 - off)
