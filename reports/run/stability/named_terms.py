"""Hard inputs of the terms and of what surrounds them: D, F, samples, frames, maps, points."""

import numpy as np
from pydantic import ValidationError

from renderer.probe import probe
from reports.run.stability.named import Measured, Named, unfit
from reports.run.stability.sides import exact, shader
from reports.stability.agreement import TOLERANCE
from reports.stability.grid import unit
from scenes.schema import Material

LAST = 1 - 2.0**-24  # the largest float32 below 1


def beckmann_horizon() -> Measured:
    z = np.array([0, 1e-45, 1e-30, 1e-10, 1e-6, 1e-5, 1e-3])
    h = unit(z, 0.7 + 0 * z).astype(np.float32)
    found = {}
    for name in ("D_beckmann", "beckmann_over_ggx"):
        values = np.concatenate([shader(name, {"h": h, "alpha": a}) for a in (1e-4, 0.1, 1.0)])
        found[f"{name}: values NaN, Inf or negative"] = (unfit(values), 0.0)
        found[f"{name}: largest, where the limit is 0"] = (float(np.nanmax(values)), 1e-30)
    return found


def ggx_cancellation() -> Measured:
    theta = 0.002 * 10 ** np.linspace(-2, 1, 200)
    h = unit(np.cos(theta), 3 * theta / theta[-1], np.sin(theta)).astype(np.float32)
    given = {"h": h, "alpha": np.float32(0.002)}
    error = np.abs(shader("D_ggx", given) / exact("D_ggx", given) - 1).max()
    cosine = h[:, 2].astype(np.float32)
    a2 = np.float32(0.002) ** 2
    textbook = a2 / (np.float32(np.pi) * (cosine * cosine * (a2 - 1) + 1) ** 2)
    there = np.abs(textbook / exact("D_ggx", given)[:, 0] - 1).max()
    return {
        "relative error": (float(error), TOLERANCE),
        "of the textbook form": (float(there), np.inf),
    }


def out_of_gamut() -> Measured:
    taken = 0.0
    for f0 in ((1.02, 0.7, 0.3), (0.95, 0.6, -0.02), (float("nan"), 0.5, 0.5)):
        try:
            Material(roughness=0.3, metallic=1.0, metal=f0)
            taken += 1
        except ValidationError:
            pass
    gold = Material(roughness=0.3, metallic=1.0, metal="Au").specular_f0
    cosine = np.linspace(0, 1, 101).astype(np.float32)
    given = {"f0": np.float32((1.02, 0.5, -0.02)), "cosine": cosine}
    worst = np.abs(shader("F_schlick", given) - exact("F_schlick", given)).max()
    return {
        "materials taken of 3 out of gamut": (taken, 0.0),
        "largest F0 of gold from its constants": (max(gold), 1.0),
        "F_schlick off its polynomial there": (float(worst), 1e-6),
    }


def number_ends() -> Measured:
    u = np.float32([(a, b) for a in (0, 1e-45, 1e-7, LAST, 1) for b in (0, 0.5, LAST, 1)])
    found: Measured = {}
    for lobe in ("ggx", "beckmann", "cosine"):
        for alpha in (1e-4, 1.0):
            w = shader(f"sample_{lobe}", {"u": u, "alpha": np.float32(alpha)}).astype(float)
            bad = ~np.isfinite(w).all(axis=1) | (w[:, 2] < 0)
            bad |= ~(np.abs(np.linalg.norm(w, axis=1) - 1) < 1e-6)
            words = f"sample_{lobe}: no unit vector above the surface"
            found[words] = (float(bad.sum()) + found.get(words, (0.0,))[0], 0.0)
    return found


def frame_poles() -> Measured:
    n = np.float32([(0, 0, -1), (0, 0, 1), (1, 0, 0), (1, 0, -0.0), (0, -1, 0), (0, -1, -0.0)])
    axes = [
        probe(f"vec4(tangent_frame(n.xyz)[{k}], 0.0)", {"n": n}, ("frame.glsl",))[:, :3]
        for k in range(3)
    ]
    M = np.stack(axes, axis=2).astype(float)
    error = np.abs(M.transpose(0, 2, 1) @ M - np.eye(3)).max()
    return {"largest part of MᵀM - 1": (float(np.nan_to_num(error, nan=np.inf)), 1e-6)}


def map_poles() -> Measured:
    w = np.float32([(0, 0, 1), (0, 0, -1), (-0.0, 0, 1), (0, -1, 0), (-0.0, -1, 0), (1e-30, 0, -1)])
    uv = shader("latlong_from_direction", {"w": w})
    v = np.abs(uv[:, 1] - [0, 1, 0, 0.5, 0.5, 1]).max()
    return {
        "values that are no number": (float((~np.isfinite(uv)).sum()), 0.0),
        "v off": (float(v), 1e-6),
    }


def last_points() -> Measured:
    worst = 0.0
    for points in (1, 2, 1024, 65_536, 1_000_000, 2**23):
        found = shader(
            "hammersley", {"index": np.float32([points - 1]), "points": np.float32(points)}
        )
        worst = max(worst, float(found.max()))
    return {"largest coordinate": (worst, float(np.nextafter(np.float32(1), np.float32(0))))}


TERMS = [
    Named(
        "beckmann-at-the-horizon",
        "D and its ratio to GGX are 0 at n.h = 0, by every way there",
        "exp(-1/0) / 0 and exp(-t) t² with infinite t are no numbers",
        beckmann_horizon,
    ),
    Named(
        "ggx-cancellation",
        "D of GGX agrees with float64 at alpha .002 within 10 alpha of n",
        "1 - cos² cancels in float32 where cos is nearly 1",
        ggx_cancellation,
    ),
    Named(
        "f0-out-of-gamut",
        "materials outside of [0, 1] are refused; gold from its constants is within",
        "kd = 1 - F would be negative; gold's red is 1.02 by some spectra, and a saturated green "
        "has a negative channel",
        out_of_gamut,
    ),
    Named(
        "random-numbers-at-their-ends",
        "samplers return unit vectors above the surface for u of 0, the last float below 1, and 1",
        "log(0) and 1/0 wait at u = 1, which rounding can make",
        number_ends,
    ),
    Named(
        "frame-at-the-poles",
        "the tangent frame is orthonormal at n.z = -1, 1, 0 and -0",
        "Frisvad's frame divides by 1 + n.z; sign(0) is 0",
        frame_poles,
    ),
    Named(
        "map-at-the-poles",
        "directions along the axes find their texels",
        "atan(0, 0) is undefined in GLSL",
        map_poles,
    ),
    Named(
        "last-point",
        "the last of up to 2^23 Hammersley points lies below 1 in both coordinates",
        "a point of 1 lies on the horizon: 32 bits as a fraction may round up to it",
        last_points,
    ),
]
