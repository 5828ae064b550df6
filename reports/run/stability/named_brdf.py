"""Hard inputs of the whole BRDF."""

from collections.abc import Callable

import numpy as np

from reports.run.stability.brdf import SURFACE
from reports.run.stability.named import Measured, Named, unfit
from reports.run.stability.sides import exact, shader
from reports.stability.agreement import TOLERANCE
from reports.stability.directions import MASKINGS
from reports.stability.functions import Inputs
from reports.stability.grid import ALPHAS, COSINES, pairs, unit
from reports.stability.maps import difference
from scenes.schema import Material

NEAR = len(COSINES)
LOBES = ("D_GGX", "D_BECKMANN", "G_GGX", "G_BECKMANN", "DIFFUSE")
UP = np.float32([[0, 0, 1], [0.6, 0, 0.8], [0.8, 0, 0.6], [1, 0, 1e-6], [0.28, 0.96, 1e-4]])
DOWN = np.float32([[0, 0, -1], [0.6, 0, -0.8], [1, 0, -1e-6], [1, 0, 0], [0, 1, -0.0]])


def surface(**changed: object) -> Inputs:
    """The inputs of `brdf` but for directions: half copper, half of each lobe, alpha .1."""
    shares = {"alpha": 0.1, "weight": (0.5, 0.5), "weight_g": (0.5, 0.5)}
    return {n: np.float32(v) for n, v in (SURFACE | shares | changed).items()}


def off(inputs: Inputs, masking: str, cells: int = 1) -> float:
    """The worst difference of the BRDF from float64; infinite if unfit.

    Args:
        cells: how many cells the rows are of, each with a peak of its own.
    """
    ours = shader("brdf", inputs, masking)
    figure = difference(ours, exact("brdf", inputs, masking), (cells,)).max()
    return np.inf if unfit(ours) else float(figure)


def both(measure: Callable[[str], float], most: float = TOLERANCE) -> Measured:
    """One figure for each masking."""
    return {f"off float64, masking {m}": (measure(m), most) for m in MASKINGS}


def near(alpha: float) -> Inputs:
    """Directions of every angle about a lobe of one width: NEAR cells, by n.v."""
    _, wi, wo = pairs(alphas=np.array([alpha]))
    return {"wi": wi, "wo": wo}


def narrowest() -> Measured:
    return both(lambda m: off(surface(alpha=1e-4) | near(1e-4), m, NEAR))


def grazing() -> Measured:
    z = 10.0 ** np.array([-6, -5, -4])
    cos_o, cos_i = np.repeat(z, 3), np.tile(z, 3)
    wo, wi = (unit(c, turn + 0 * c).astype(np.float32) for c, turn in ((cos_o, 0), (cos_i, np.pi)))

    def worst(masking: str) -> float:
        given = [surface(alpha=a) | {"wi": wi, "wo": wo} for a in ALPHAS[::4]]
        return max(off(g, masking, cells=len(wo)) for g in given)

    return both(worst)


def below() -> Measured:
    wi, wo = np.repeat(UP, len(DOWN), axis=0), np.tile(DOWN, (len(UP), 1))
    found = [
        np.abs(shader("brdf", surface() | {"wi": a, "wo": b}, m)).max()
        for m in MASKINGS
        for a, b in ((wi, wo), (wo, wi), (wo, wo))
    ]
    return {"largest |f|": (float(np.nan_to_num(found, nan=np.inf).max()), 0.0)}


def almost_below() -> Measured:
    tiny = 10.0 ** -np.arange(6, 46, 2)
    wo = unit(tiny, 0 * tiny).astype(np.float32)
    found = 0.0
    for alpha in (1e-4, 0.01, 1.0):
        for wi in (wo * np.float32([-1, -1, 1]), wo, wo * 0 + UP[1]):
            for m in MASKINGS:
                found += unfit(shader("brdf", surface(alpha=alpha) | {"wi": wi, "wo": wo}, m))
    return {"values NaN, Inf or negative": (found, 0.0)}


def opposite() -> Measured:
    directions = np.concatenate([UP, DOWN])
    both_ways = {"wi": directions, "wo": -directions}
    found = [shader("brdf", surface() | both_ways, m) for m in MASKINGS]
    return {"largest |f|": (float(np.nan_to_num(np.abs(found), nan=np.inf).max()), 0.0)}


def nearly_opposite() -> Measured:
    turn = 10.0 ** np.linspace(-7, -2, 50)
    wo = unit(np.full(50, 1e-5), 0 * turn).astype(np.float32)
    wi = unit(np.full(50, 3e-5), np.pi + turn).astype(np.float32)
    given = surface(alpha=0.3, weight=(0, 1), weight_g=(0, 1)) | {"wi": wi, "wo": wo}
    return both(lambda m: off(given, m, cells=len(turn)))


def mirrored() -> Measured:
    cosine = 10.0 ** np.linspace(-6, 0, 25)
    wo = unit(cosine, 0.4 + 0 * cosine).astype(np.float32)

    def worst(masking: str) -> float:
        mirror = {"wi": wo * np.float32([-1, -1, 1]), "wo": wo}
        given = [surface(alpha=a) | mirror for a in (1e-4, 0.01, 1.0)]
        return max(off(g, masking, cells=len(wo)) for g in given)

    return both(worst)


def lobes_left_out() -> Measured:
    found = 0.0
    for masking in MASKINGS:
        for weight in ((1.0, 0.0), (0.0, 1.0)):
            given = surface(weight=weight, weight_g=weight) | near(0.1)
            needed, every = (shader("brdf", given, masking, lobes) for lobes in ((), LOBES))
            found = max(found, float(difference(needed, every, ()).max()))
    return {"difference from all lobes compiled in": (found, 1e-6)}


def weight_tiny() -> Measured:
    def worst(masking: str) -> float:
        ends = [(1e-7, 1 - 1e-7), (1 - 1e-7, 1e-7), (1e-30, 1.0)]
        return max(off(surface(weight=w, weight_g=w) | near(0.1), masking, NEAR) for w in ends)

    return both(worst)


def weights_off() -> Measured:
    def worst(masking: str) -> float:
        sums = [(0.3, 0.70000005), (0.3, 0.6999999), (1.0, 6e-8)]
        return max(off(surface(weight=w, weight_g=w) | near(0.1), masking, NEAR) for w in sums)

    return both(worst)


def metallic() -> Measured:
    found = {}
    for share in (0.0, 0.5, 1.0):
        m = Material(albedo=(0.6, 0.3, 0.05), roughness=0.4, metallic=share, metal="Cu", weight=0.5)
        given = surface(alpha=m.alpha, albedo=m.diffuse_albedo, f0=m.specular_f0) | near(m.alpha)
        worst = max(off(given, masking, NEAR) for masking in MASKINGS)
        found[f"off float64 at metallic {share:g}"] = (worst, TOLERANCE)
    return found


def f0_ends() -> Measured:
    found = {}
    for f0 in (0.0, 1.0):
        given = surface(f0=(f0,) * 3, albedo=(0.5,) * 3) | near(0.1)
        found[f"off float64 at F0 = {f0:g}"] = (
            max(off(given, m, NEAR) for m in MASKINGS),
            TOLERANCE,
        )
    white = surface(f0=(1.0,) * 3, albedo=(0.5,) * 3) | near(0.1)
    bare = white | {"albedo": np.float32((0.0,) * 3)}
    kd = max(np.abs(shader("brdf", white, m) - shader("brdf", bare, m)).max() for m in MASKINGS)
    found["diffuse light under F0 = 1"] = (float(kd), 0.0)
    return found


def not_unit() -> Measured:
    def worst(masking: str) -> float:
        given = near(0.1)
        scaled = [
            {"wi": given["wi"] * np.float32(i), "wo": given["wo"] * np.float32(o)}
            for i in (1 - 1e-6, 1 + 1e-6)
            for o in (1 - 1e-6, 1, 1 + 1e-6)
        ]
        return max(off(surface() | s, masking, NEAR) for s in scaled)

    cosine = np.float32([1, 1 + 1e-7, 1 + 1e-6, 1.01, -1e-7, -1])
    F = shader("F_schlick", {"f0": np.float32((0.04, 0.5, 1.0)), "cosine": cosine})
    return both(worst) | {"F outside of [F0, 1]": (float(((F < 0.04) | (F > 1)).sum()), 0.0)}


BRDF = [
    Named(
        "narrowest-lobe",
        "f agrees with float64 at alpha 1e-4, for n.v and n.l from 1e-6 to 1",
        "D is 3e7 at its peak and 0 a thousandth of a degree away",
        narrowest,
    ),
    Named(
        "both-graze",
        "f agrees with float64 where n.v and n.l are 1e-6 to 1e-4 and wi mirrors wo",
        "G and both cosines go to 0 together, and wi.h with them: 0/0 in the limit",
        grazing,
    ),
    Named(
        "below-the-surface",
        "f is exactly 0 where n.v or n.l is 0 or below",
        "interpolated normals face away from the eye at silhouettes; light comes from everywhere",
        below,
    ),
    Named(
        "almost-below",
        "f is finite and not negative for n.v and n.l down to 1e-45",
        "1 / (n.v n.l) leaves float32, and its square already at 1e-19",
        almost_below,
    ),
    Named(
        "opposite",
        "f is exactly 0 where wi = -wo",
        "the half vector of opposite directions is 0/0",
        opposite,
    ),
    Named(
        "nearly-opposite",
        "f agrees with float64 where both graze and wi is -wo but for 1e-7 to 1e-2 radians",
        "wi + wo keeps few digits, and 1 - F even fewer: F is nearly 1 there",
        nearly_opposite,
    ),
    Named(
        "h-is-n",
        "f agrees with float64 where wi mirrors wo exactly, n.v from 1e-6 to 1",
        "the lobe's very peak, where every mirror looks",
        mirrored,
    ),
    Named(
        "lobes-left-out",
        "f with a lobe compiled out is f with that lobe's weight at 0",
        "0 times a lobe's Inf is no number, and a lobe left out must not be missed",
        lobes_left_out,
    ),
    Named(
        "weight-of-1e-7",
        "f agrees with float64 at weights 1e-7, 1 - 1e-7 and 1e-30",
        "1 - w of a float32 near 1 has no digits left",
        weight_tiny,
    ),
    Named(
        "weights-off-by-rounding",
        "f agrees with float64 at weights that sum to 1 but for rounding",
        "nothing may divide by 1 - w or take a root of it",
        weights_off,
    ),
    Named(
        "metallic",
        "f agrees with float64 at metallic 0, .5 and 1",
        "the diffuse lobe is left out at 1, and only there",
        metallic,
    ),
    Named(
        "f0-at-its-ends",
        "f agrees with float64 at F0 = 0 and 1, and F0 = 1 leaves no diffuse light",
        "kd = 1 - F is 0 there and must not round below it",
        f0_ends,
    ),
    Named(
        "not-quite-unit",
        "f agrees with float64 for directions 1e-6 too long or short, and F stays in [F0, 1]",
        "normalised float32 vectors are off by 1e-7, interpolated ones by more",
        not_unit,
    ),
]
