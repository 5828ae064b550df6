"""The BRDF's terms one by one, D, G, F and the samples, against double precision."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from reports.run.stability.sides import exact, shader
from reports.stability.agreement import TOLERANCE, off_by
from reports.stability.directions import MASKINGS
from reports.stability.functions import Inputs
from reports.stability.grid import (
    ALPHA,
    ALPHAS,
    COSINE,
    COSINES,
    JUDGED,
    ONE,
    WEIGHT,
    WEIGHTS,
    axis,
    pairs,
    spread,
    unit,
)
from reports.stability.maps import SCALE, difference, make_map
from reports.stability.oracle import F_schlick
from reports.stability.results import Axis, Map

AROUND = 32  # azimuths in a cell
TILT = axis("tan(h)/alpha", 10 ** np.linspace(-2, 4, 13), log=True)
LAST = 1 - 2.0**-24  # the largest float32 below 1
U = axis("u.x", [0, 1e-7, 1e-4, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9999, 1 - 1e-6, LAST])
POINT = 2.0**-23  # both parts of a sample point are rounded to 24 bits
COUNTS = axis("points", [1, 2, 3, 16, 96, 1000, 1024, 65_535, 1_000_000], log=True)
PLACES = axis("index over points", np.linspace(0, 1, 65))
F0 = axis("f0", [-0.05, 0, 0.04, 0.5, 0.95, 1, 1.02])
F0_WITHIN = np.array([0, 1e-4, 0.04, 0.5, 0.95, 1])
TINTS = axis("tint", [0, 0.1, 0.5, 0.9, 1])
ETA = axis("eta", [0.05, 0.5, 0.999, 1, 1 + 2.0**-20, 1.05, 1.33, 1.5, 2.4, 5])
K = axis("k", [0, 1e-3, 0.5, 1, 3, 10])
ANGLE = axis("cosine", 10 ** np.linspace(-6, 0, 25), log=True)
SHARES = np.stack([WEIGHTS, 1 - WEIGHTS], axis=1)
OF_ALPHA = {"alpha": JUDGED["alpha"]}
Measure = Callable[[np.ndarray, np.ndarray, Inputs], np.ndarray]


def maps() -> Iterator[Map]:
    """Every term."""
    yield from ndfs()
    yield from maskings()
    yield fresnel()
    yield from fresnel_of_models()
    yield density()
    yield from samplers()
    yield from visible()
    yield hammersley()


def term(
    name: str,
    axes: tuple[Axis, Axis, Axis],
    inputs: Inputs,
    by_slice: Inputs | None = None,
    measure: Measure | None = None,
    masking: str = "",
    **said: Any,
) -> Map:
    """One function against float64.

    Args:
        inputs: (n, parts), n rows over the cells of a slice.
        by_slice: (slices, parts), what holds for all of a slice.
        measure: the figures of what the shader and float64 return and of the inputs, (n,) or
            (rows, columns, k); by default their difference, with the cell's own peak.
    """
    cells = (len(axes[1].values), len(axes[2].values))
    by_slice = by_slice or {}
    figures = []
    for k in range(len(axes[0].values)):
        given = inputs | {n: v[k] for n, v in by_slice.items()}
        sides = [side(name, given, masking or "paper") for side in (shader, exact)]
        found = measure(*sides, given) if measure else difference(*sides, cells)
        figures.append(found.reshape(*cells, -1))

    def reproduce(at):
        row = np.ravel_multi_index(at[1:], figures[0].shape)
        shown = {n: v[row] for n, v in inputs.items()} | {n: v[at[0]] for n, v in by_slice.items()}
        return [shown | ({"masking": masking} if masking else {})]

    said = {"why": ROUNDING, "unit": SCALE, "limit": TOLERANCE} | said
    return make_map(
        name, "against float64", np.stack(figures), axes, reproduce, masking=masking, **said
    )


ROUNDING = "The same formula from the same float32 inputs: what is left is rounding."


def ndfs() -> Iterator[Map]:
    """D, and what one lobe's samples are worth to the other, over tilts of h and widths."""
    tilt, alpha = spread(TILT.values, ALPHAS, AROUND)
    theta = np.arctan(tilt * alpha)
    turn = np.random.default_rng(1).uniform(0, 2 * np.pi, theta.size)
    h = unit(np.cos(theta), turn, np.sin(theta)).astype(np.float32)
    inputs = {"h": h, "alpha": alpha.astype(np.float32)}
    shape = (len(TILT.values), len(ALPHAS))

    def beside_peak(name: str) -> Measure:
        def measure(ours, truth, given):
            top = exact(name, given | {"h": np.float32([[0, 0, 1]])}, "paper")
            return difference(ours, truth, shape, top)

        return measure

    why = "The sine comes from h's components: 1 - cos² would err by 2 % at alpha .002."
    for name in ("D_ggx", "D_beckmann"):
        yield term(
            name, (ONE, TILT, ALPHA), inputs, None, beside_peak(name), why=why, judged=OF_ALPHA
        )
    yield term(
        "D_mixture",
        (WEIGHT, TILT, ALPHA),
        inputs,
        {"weight": SHARES},
        beside_peak("D_mixture"),
        why=why,
        judged=OF_ALPHA,
    )
    yield term(
        "beckmann_over_ggx",
        (ONE, TILT, ALPHA),
        inputs,
        None,
        lambda ours, truth, _: difference(ours, truth, shape, 4 / np.e),
        why="GGX samples serve Beckmann by this ratio, also far out, where it is 0 times infinity.",
        judged=OF_ALPHA,
    )


def maskings() -> Iterator[Map]:
    """G and its parts over angles and widths."""
    cosine, alpha = spread(COSINES, ALPHAS, AROUND)
    turn = np.random.default_rng(2).uniform(0, 2 * np.pi, cosine.size)
    alpha = alpha.astype(np.float32)
    w = unit(cosine, turn).astype(np.float32)
    one = {"w": w, "alpha": alpha}
    tan = {"tan": (np.sqrt(1 - cosine**2) / cosine).astype(np.float32), "alpha": alpha}
    for name, inputs in (("G1_ggx", one), ("lambda_ggx", tan), ("lambda_beckmann", tan)):
        yield term(name, (ONE, COSINE, ALPHA), inputs, judged=JUDGED)
    mixed = (WEIGHT, COSINE, ALPHA)
    yield term("G1_smith_mixture", mixed, one, {"weight": SHARES}, judged=JUDGED)

    alpha, wi, wo = pairs()
    both = {"wi": wi, "wo": wo}
    yield term("G_vcavity", (ONE, COSINE, ALPHA), both, judged=JUDGED)
    both["alpha"] = alpha
    yield term("G_smith", (ONE, COSINE, ALPHA), both, judged=JUDGED)
    for masking in MASKINGS:
        yield term("G_mixture", mixed, both, {"weight": SHARES}, masking=masking, judged=JUDGED)


def fresnel() -> Map:
    """F over F0 and angle."""
    f0, cosine = (v.astype(np.float32) for v in spread(F0.values, ANGLE.values, 1))
    return term(
        "F_schlick",
        (ONE, F0, ANGLE),
        {"f0": np.repeat(f0[:, None], 3, axis=1), "cosine": cosine},
        why="A polynomial: it must follow any F0, also one outside of [0, 1], without breaking.",
    )


def fresnel_of_models() -> Iterator[Map]:
    """F of the other models over their constants and angle, and 1 - F."""
    tint, cosine = spread(TINTS.values, ANGLE.values, len(F0_WITHIN))
    f0 = np.tile(F0_WITHIN, len(tint) // len(F0_WITHIN))
    tinted = {"f0": f0, "f82": tint * F_schlick(f0[:, None], np.full(len(f0), 1 / 7))[:, 0]}
    tinted = {n: np.repeat(v[:, None], 3, axis=1).astype(np.float32) for n, v in tinted.items()}
    tinted["cosine"] = cosine.astype(np.float32)
    eta, cosine = (v.astype(np.float32) for v in spread(ETA.values, ANGLE.values, 1))
    index = {"eta": eta, "cosine": cosine}
    why = "Written so that nothing cancels where F is near 0 or 1."
    for name in ("F_", "one_minus_F_"):
        yield term(f"{name}f82", (ONE, TINTS, ANGLE), tinted, None, _whole, why=why)
        yield term(f"{name}dielectric", (ONE, ETA, ANGLE), index, None, _whole, why=why)
        slices = {"k": np.float32(K.values)}
        yield term(f"{name}conductor", (K, ETA, ANGLE), index, slices, _whole, why=why)


def _whole(ours: np.ndarray, truth: np.ndarray, _given: Inputs) -> np.ndarray:
    """A share of light beside all of it: the peak of F and of 1 - F is 1."""
    return off_by(ours, truth, 1.0).max(axis=1)


def density() -> Map:
    """Density of all lobes' samples together."""
    alpha, wi, wo = pairs()
    counts = np.float32([[0, 2, 1], [1, 1, 1], [2, 0, 1], [0, 0, 1]])
    return term(
        "sample_density",
        (axis("lobes", range(len(counts))), COSINE, ALPHA),
        {"wi": wi, "wo": wo, "alpha": alpha},
        {"count": counts},
        why="Light is divided by it. Slices: Beckmann, both, GGX, each with the cosine lobe, and "
        "that alone.",
        judged=JUDGED,
    )


def samplers() -> Iterator[Map]:
    """Where random numbers are sent, at their ends too."""
    first, alpha = spread(U.values, ALPHAS, AROUND)
    second = np.random.default_rng(3).uniform(0, 1, first.size)
    second[::AROUND], second[1::AROUND] = 0, LAST
    u = np.stack([first, second], axis=1).astype(np.float32)
    given = {"u": u, "alpha": alpha.astype(np.float32)}
    for lobe in ("ggx", "beckmann", "cosine"):
        inputs = given if lobe != "cosine" else {"u": u}
        yield term(
            f"sample_{lobe}",
            (ONE, U, ALPHA),
            inputs,
            None,
            lambda ours, truth, _: turned(ours, truth),
            why="Random numbers from 0 to the last float32 below 1 all give directions, and those "
            "of the formula.",
            unit="error of n.h and of its sine, relative",
            judged=OF_ALPHA,
        )


def visible() -> Iterator[Map]:
    """Visible normals: where random numbers are sent, and how densely."""
    alpha, wi, wo = pairs()
    yield term(
        "pdf_visible_ggx",
        (ONE, COSINE, ALPHA),
        {"wi": wi, "wo": wo, "alpha": alpha},
        why="Light is divided by it; its tail is denser than that of the normals that are seen.",
        judged=JUDGED,
    )
    counts = np.float32([[1, 0, 0], [1, 1, 0], [0, 1, 0]])
    yield term(
        "filtered_density",
        (axis("lobes", range(len(counts))), COSINE, ALPHA),
        {"wi": wi, "wo": wo, "alpha": alpha},
        {"count": counts},
        why="Light is divided by it. Slices: visible normals, with the cosine lobe, that alone.",
        judged=JUDGED,
    )
    first, alpha = spread(U.values, ALPHAS, AROUND)
    rng = np.random.default_rng(4)
    u = np.stack([first, rng.uniform(0, 1, first.size)], axis=1).astype(np.float32)
    wo = unit(rng.uniform(0.02, 1, first.size), rng.uniform(0, 6, first.size)).astype(np.float32)
    yield term(
        "sample_visible_ggx",
        (ONE, U, ALPHA),
        {"u": u, "wo": wo, "alpha": alpha.astype(np.float32)},
        None,
        lambda ours, truth, _: turned(ours, truth),
        why="Random numbers from 0 to the last float32 below 1 all give facets that can be seen.",
        unit="error of n.h and of its sine, relative",
        judged=OF_ALPHA,
    )


def hammersley() -> Map:
    """Points against exact binary fractions, and within [0, 1)."""
    points, place = spread(COUNTS.values, PLACES.values, 1)
    index = np.minimum(np.round(place * points), points - 1)
    given = {"index": index, "points": points}
    found = shader("hammersley", given)
    off = np.abs(found - exact("hammersley", given)).max(axis=1)
    off[(found < 0).any(axis=1) | (found >= 1).any(axis=1)] = np.inf
    return make_map(
        "hammersley",
        "against float64",
        off.reshape(1, len(COUNTS.values), len(PLACES.values), 1),
        (ONE, COUNTS, PLACES),
        lambda at: [{n: v[at[1] * len(PLACES.values) + at[2]] for n, v in given.items()}],
        why="A point of 1 would be sent to the horizon: 32 bits as a fraction round up to it.",
        unit="difference; infinite outside of [0, 1)",
        limit=POINT,
    )


def turned(ours: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """How far off a direction is: along n, and across as a share of the sine."""
    off = np.abs(ours.astype(float) - truth)
    sine = np.maximum(np.hypot(truth[:, 0], truth[:, 1]), 1e-30)
    cosine = np.maximum(np.abs(truth[:, 2]), 1e-30)
    found = np.maximum(np.hypot(off[:, 0], off[:, 1]) / sine, off[:, 2] / cosine)
    return np.where(np.isfinite(ours).all(axis=1), found, np.inf)
