"""Where directions lie: tangent frames, and places in a lat-long map."""

from collections.abc import Iterator

import numpy as np

from renderer.probe import probe
from reports.run.stability.sides import exact, shader
from reports.stability.grid import ONE, axis, spread, unit
from reports.stability.maps import make_map
from reports.stability.results import Axis, Map

ORTHONORMAL = 1e-6
ANGLE = 1e-5  # radians; a texel of a 16,384 x 8,192 map is 4e-4, and drivers' atan errs by 3e-6
Z = axis("n.z", [-1, -1 + 2**-20, -0.9, -0.1, -1e-7, 0, 1e-7, 0.1, 0.9, 1 - 2**-20, 1])
TURN = axis("azimuth", np.linspace(0, 2 * np.pi, 17))
POLAR = axis(
    "polar angle", [0, 1e-6, 1e-3, 0.1, 0.5, 1, 1.5, 2, 3, np.pi - 1e-3, np.pi - 1e-6, np.pi]
)


def maps() -> Iterator[Map]:
    """Every function of the kind."""
    yield tangent_frame()
    yield latlong()


def tangent_frame() -> Map:
    """Orthonormal and right-handed for every n, the poles and both zeros among them."""
    z, turn = spread(Z.values, TURN.values, 1)
    n = unit(z, turn).astype(np.float32)
    columns = [
        probe(f"vec4(tangent_frame(n.xyz)[{k}], 0.0)", {"n": n}, ("frame.glsl",))[:, :3]
        for k in range(3)
    ]
    M = np.stack(columns, axis=2).astype(float)
    with np.errstate(invalid="ignore"):  # of a frame that is broken
        off = np.abs(M.transpose(0, 2, 1) @ M - np.eye(3)).max(axis=(1, 2))
        off = np.maximum(off, np.abs(np.linalg.det(M) - 1))
    return make_map(
        "tangent_frame",
        "orthonormal",
        _cells(off, Z, TURN),
        (ONE, Z, TURN),
        lambda at: [{"n": n[at[1] * len(TURN.values) + at[2]]}],
        why="Light is turned into this frame and back: it must neither shear nor mirror it, also "
        "at n.z = -1 and where n.z changes sign.",
        unit="largest part of MᵀM - 1 and of det M - 1",
        limit=ORTHONORMAL,
    )


def latlong() -> Map:
    """A direction to the map and back."""
    polar, turn = spread(POLAR.values, TURN.values, 1)
    w = unit(np.cos(polar), turn, np.sin(polar)).astype(np.float32)
    call = "vec4(direction_from_latlong(latlong_from_direction(w.xyz, 0.0), 0.0), 0.0)"
    back = probe(call, {"w": w}, ("latlong.glsl",))[:, :3]
    off = np.linalg.norm(back.astype(float) - w, axis=1)
    sides = (side("latlong_from_direction", {"w": w}) for side in (shader, exact))
    off = np.maximum(off, away(*sides, w))
    return make_map(
        "latlong_from_direction",
        "round trip",
        _cells(off, POLAR, TURN),
        (ONE, POLAR, TURN),
        lambda at: [{"w": w[at[1] * len(TURN.values) + at[2]]}],
        why="A direction finds its texel and comes back, at the poles, where azimuth has no "
        "meaning, and across the seam.",
        unit="radians, of the way back and of the place on the map",
        limit=ANGLE,
    )


def away(found: np.ndarray, uv: np.ndarray, w: np.ndarray) -> np.ndarray:
    """How far two places (n, 2) of directions w (n, 3) on a lat-long map are apart, in radians.

    At a pole every u is right; elsewhere it counts by the circle that it runs around.
    """
    circle = np.hypot(w[:, 0], w[:, 1]) * 2 * np.pi
    across = np.abs((found - uv)[:, 0] + 0.5) % 1 - 0.5
    return np.maximum(np.abs(across) * circle, np.abs(found - uv)[:, 1] * np.pi)


def _cells(figures: np.ndarray, rows: Axis, columns: Axis) -> np.ndarray:
    """Figures (n,) of one slice as slices x rows x columns x k."""
    return figures.reshape(1, len(rows.values), len(columns.values), -1)
