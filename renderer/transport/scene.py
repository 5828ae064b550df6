"""A scene's baked geometry on the GPU."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from renderer.program import Maps
from renderer.transport import stored
from renderer.transport.bvh import build
from renderer.transport.placed import Placed, four, place
from renderer.transport.rows import holding
from renderer.transport.tessellation import Tessellation, tessellate
from renderer.transport.visibility import MOST_VERTICES, NOBODY, PER_SEEN, SEEN, Visibility, bake
from scenes.schema import Case

SIGHT_BITS = 32 - PER_SEEN  # as in shaders/here.glsl
assert MOST_VERTICES * SEEN**2 < 1 << SIGHT_BITS and PER_SEEN == 4
TOGETHER = 4  # sights of a vertex, beside one another, that are shaded as one until the last bounce


@dataclass(frozen=True, eq=False)
class SceneGeometry(Placed):
    """What depends on a scene's geometry alone.

    Attributes:
        first_sight: of each object, and how many there are.
        size: of the scene's bounding box, its longest side.
    """

    first_sight: tuple[int, ...]
    size: float


def scene_geometry(case: Case) -> SceneGeometry:
    """The baked geometry of a case, from disk where it has been made before."""
    return _loaded(stored.placement(case))


@lru_cache(maxsize=4)
def _loaded(placement: stored.Placement) -> SceneGeometry:
    objects, visibility = stored.baked(placement.key, lambda: _made(placement.case))
    placed = place(objects)
    sights, index, owner = _sights(visibility)
    baked = {
        "open_bits": holding(visibility.open.reshape(-1, 1), "u4"),
        "clear_bits": holding(visibility.clear.reshape(-1, 1), "u4"),
        "flux": holding(visibility.flux.reshape(-1, 2), "f1"),
        "sights": holding(sights, "u4"),
        "seen_index": holding(index, "u4"),
        "sight_owner": holding(owner, "u4"),
        **_tree(placed.triangles),
    }
    size = float(np.ptp(placed.triangles.reshape(-1, 3), axis=0).max())
    fields = vars(placed) | {"maps": placed.maps | baked}
    first = np.searchsorted(owner[:, 0], np.cumsum([0, *(len(t.vertices) for t in objects)]))
    return SceneGeometry(**fields, first_sight=tuple(first.tolist()), size=size)


def _tree(triangles: np.ndarray) -> Maps:
    """The textures of a hierarchy over triangles (n, 3, 3)."""
    tree = build(triangles)
    at = np.where(tree.order[:, None, None] >= 0, triangles[tree.order], 0)
    sides = np.stack([at[:, 0], at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]], axis=1)
    numbers = np.repeat(tree.order, 3).astype(np.float32)
    return {
        "bvh_nodes": holding(tree.nodes.reshape(-1, 4), "f4"),
        "bvh_triangles": holding(four(sides.reshape(-1, 3), numbers), "f4"),
    }


def _sights(visibility: Visibility) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sights (m, WITNESSES) uint32, vertex by vertex; of each vertex and coarse direction its sight
    in the lower SIGHT_BITS, all ones for none, and what is open of it in those above, (vertices
    SEEN², 1) uint32; and the vertex of each sight, (m, 1) uint32.

    The last of a vertex stands several times, so that it has groups of TOGETHER.
    """
    counts = visibility.seeing.sum(axis=1)
    owner = np.repeat(np.arange(len(counts)), -(-counts // TOGETHER) * TOGETHER)
    held = np.bincount(owner, minlength=len(counts))
    rank = np.arange(len(owner)) - np.repeat(np.cumsum(held) - held, held)
    own = (np.cumsum(counts) - counts)[owner] + np.minimum(rank, counts[owner] - 1)
    sight = np.full(visibility.seeing.size, NOBODY >> PER_SEEN)
    sight[visibility.seeing.ravel()] = np.flatnonzero(rank < counts[owner])
    eight = visibility.open.view(np.uint8).ravel()
    open_there = np.stack([eight & 15, eight >> 4], axis=1).ravel()  # PER_SEEN bits each
    index = sight | open_there.astype(np.uint32) << SIGHT_BITS
    return visibility.sights[own], index[:, None], owner.astype(np.uint32)[:, None]


def _made(case: Case) -> tuple[list[Tessellation], Visibility]:
    objects = tessellate(case)
    return objects, bake(objects)
