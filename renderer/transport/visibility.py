"""What each vertex of a scene sees of the scene: a bit per direction, and whom it sees."""

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from renderer.transport.directions import cell_directions, cell_shares, cells_around
from renderer.transport.rays import Rays
from renderer.transport.tessellation import Tessellation
from scenes.errors import InputError

SIDE = 32  # cells of the octahedral map that has a bit each
SEEN = 16  # and of the coarser one that names what is seen
PER_SEEN = (SIDE // SEEN) ** 2  # fine cells in a coarse one; they follow one another
CHUNK = 1024  # vertices traced together
MOST_THREADS = 8  # each of them holds 100 MB
JUST_BELOW, JUST_ABOVE = 0.1, 0.01  # cosines: how far below the horizon, and from where on
LIFT = 1e-4  # of the scene's size: how far rays start from the surface
FLUX = 1 / 8160  # in the middle of a face of the octahedron a coarse cell's share is .027
WITNESSES = 3  # vertices that stand for what blocks a coarse direction
VERTEX_BITS = 22  # of a witness; the rest names the fine cell that it stands in
MOST_VERTICES = 1_000_000  # which may take 5 gigabytes: 153,000 of the bunnies take 740 MB
VERTEX = np.uint32((1 << VERTEX_BITS) - 1)
NOBODY = np.uint32(0xFFFFFFFF)


@dataclass(frozen=True, eq=False)
class Visibility:
    """Of all vertices of a scene, counted through its objects.

    Attributes:
        open: (n, SIDE² / 32) uint32, bit c of word w: nothing stands in direction 32 w + c.
        clear: the same, where nothing stands in the cells around either: a ray there surely
            misses everything.
        flux: (n, SEEN², 2) uint8, of a vertex's irradiance under even light the share that comes
            through a coarse direction, in FLUX: where it is open, and where it is not.
        seeing: (n, SEEN²) bool, whether something that shows its front blocks a coarse direction.
        sights: (m, WITNESSES) uint32, for each of these, in order, some of the vertices that do:
            in the lower VERTEX_BITS, with the fine cell that each stands in above them. NOBODY
            for what shows its back, which is black.
    """

    open: np.ndarray
    clear: np.ndarray
    flux: np.ndarray
    seeing: np.ndarray
    sights: np.ndarray


def bake(objects: list[Tessellation]) -> Visibility:
    """Trace every vertex's half of the directions; those well below its horizon are blocked.

    Raises:
        InputError: there are more vertices than a witness can name.
    """
    vertices = np.concatenate([t.vertices for t in objects])
    if len(vertices) > MOST_VERTICES:
        problem = (
            f"{len(vertices):,} vertices are more than the {MOST_VERTICES:,} that can be baked"
        )
        raise InputError("scene", "objects", problem, "simplify a mesh, or draw without occlusion")
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    size = np.ptp(vertices, axis=0).max()
    normals = np.concatenate([t.normals for t in objects])
    first = np.cumsum([0, *(len(t.vertices) for t in objects)])
    corners = np.concatenate([t.faces + n for t, n in zip(objects, first, strict=False)])
    facing = np.cross(*(vertices[corners[:, k]] - vertices[corners[:, 0]] for k in (1, 2)))
    rays = Rays(objects, middle)
    starts = vertices - middle + LIFT * size * normals

    def traced(k: int) -> tuple[np.ndarray, ...]:
        return _traced(rays, starts[k : k + CHUNK], normals[k : k + CHUNK], corners, facing)

    # Embree and numpy let other threads run.
    with ThreadPoolExecutor(min(os.cpu_count() or 1, MOST_THREADS)) as pool:
        parts = list(pool.map(traced, range(0, len(vertices), CHUNK)))
    return Visibility(*(np.concatenate(of) for of in zip(*parts, strict=True)))


def _traced(
    rays: Rays, starts: np.ndarray, normals: np.ndarray, corners: np.ndarray, facing: np.ndarray
) -> tuple[np.ndarray, ...]:
    directions = cell_directions(SIDE, SEEN)
    cosines = normals @ directions.T
    who, where = np.nonzero(cosines > -JUST_BELOW)
    # What lies across the horizon is asked just above it: a cell there is half above, and pixels
    # between vertices have horizons of their own.
    lift = np.maximum(JUST_ABOVE - cosines[who, where], 0)[:, None]
    d = (directions[where] + lift * normals[who]).astype(np.float32)
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    hits = rays.first(starts[who].astype(np.float32), d)
    free = np.zeros((len(starts), SIDE * SIDE), bool)
    free[who, where] = hits.triangle < 0
    blocked = hits.triangle >= 0
    who, where, d = who[blocked], where[blocked], d[blocked]
    triangle, u, v = (x[blocked] for x in (hits.triangle, hits.u, hits.v))
    front = (facing[triangle] * d).sum(axis=1) < 0
    nearest = np.argmax(np.stack([1 - u - v, u, v], axis=1), axis=1)
    corner = corners[triangle, nearest].astype(np.uint32)
    flux = _flux(free, cosines)
    return _words(free), _words(_clear(free)), flux, *_seen(len(starts), who, where, front, corner)


def _clear(free: np.ndarray) -> np.ndarray:
    """Where all cells around are open too; eight vertices at a time, as bits."""
    bits = np.packbits(free.T, axis=1)
    clear = np.bitwise_and.reduce([bits[near] for near in cells_around(SIDE, SEEN).T])
    return np.ascontiguousarray(np.unpackbits(clear, axis=1, count=len(free)).T).view(bool)


def _flux(free: np.ndarray, cosines: np.ndarray) -> np.ndarray:
    """The field `flux` from what is open, and each vertex's cosines of all directions."""
    share = np.maximum(cosines, 0) * cell_shares(SIDE, SEEN)
    share /= np.maximum(share.sum(axis=1, keepdims=True), 1e-30)
    through = np.stack([share * free, share * ~free], axis=2)
    through = through.reshape(len(free), SEEN**2, PER_SEEN, 2).sum(axis=2)
    return np.round(through / FLUX).astype(np.uint8)


def _words(bits: np.ndarray) -> np.ndarray:
    return np.packbits(bits, axis=1, bitorder="little").view(np.uint32)


def _seen(
    count: int, who: np.ndarray, where: np.ndarray, front: np.ndarray, corner: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """`seeing` and `sights` of some vertices: of what blocks a coarse cell, some evenly spread."""
    key = who * SEEN**2 + where // PER_SEEN
    blocked = np.bincount(key, minlength=count * SEEN**2)
    entry = np.where(front, corner | where.astype(np.uint32) << VERTEX_BITS, NOBODY)
    entry = entry[np.argsort(key, kind="stable")]
    full = np.flatnonzero(blocked)
    begins = (np.cumsum(blocked) - blocked)[full]
    pick = (2 * np.arange(WITNESSES) + 1) * blocked[full, None] // (2 * WITNESSES)
    sights = entry[begins[:, None] + pick]
    shown = (sights != NOBODY).any(axis=1)
    seeing = np.zeros(count * SEEN**2, bool)
    seeing[full[shown]] = True
    return seeing.reshape(count, SEEN**2), sights[shown]
