"""A scene's baked visibility on the GPU, and the light that its surfaces send one another."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import moderngl
import numpy as np

from renderer.context import context
from renderer.program import Maps, bind_maps, fill, set_uniforms
from renderer.targets import release
from renderer.transport import stored
from renderer.transport.tessellation import Tessellation, tessellate
from renderer.transport.visibility import NOBODY, SEEN, VERTEX, Visibility, bake
from scenes.schema import Case

ROW = 4096  # as in shaders/rows.glsl
BOUNCES = 3  # of light between surfaces; what is left of it is a hundredth of it on silver


@dataclass(frozen=True, eq=False)
class SceneGeometry:
    """What depends on a scene's geometry alone.

    Attributes:
        maps: `open_bits`, `sights`, `sight_index`, `corners`, `positions`, `normals`, by their
            names in GLSL.
        middle: (3,) float64, world; positions are from there.
        buffers: vertices (position, normal: 6 float32) and indices (uint32) of each object.
        first_triangle: of each object, counted through the scene.
        first_sight: the first sight of each object by another surface; last, how many there are.
    """

    maps: Maps
    middle: np.ndarray
    buffers: list[tuple[moderngl.Buffer, moderngl.Buffer]]
    first_triangle: list[int]
    first_sight: list[int]


def scene_geometry(case: Case) -> SceneGeometry:
    """The baked geometry of a case, from disk where it has been made before."""
    return _loaded(stored.key(case), case.model_copy(update={"id": ""}))


@lru_cache(maxsize=4)
def _loaded(_key: str, case: Case) -> SceneGeometry:
    objects, visibility = stored.baked(_key, lambda: _made(case))
    vertices = np.concatenate([t.vertices for t in objects])
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    normals = np.concatenate([t.normals for t in objects])
    first_vertex = np.cumsum([0, *(len(t.vertices) for t in objects)]).tolist()
    first_triangle = np.cumsum([0, *(len(t.faces) for t in objects)]).tolist()
    corners = np.concatenate([t.faces + n for t, n in zip(objects, first_vertex, strict=False)])
    sights, index = _sights(visibility.seen)
    gl = context()
    return SceneGeometry(
        maps={
            "open_bits": _rows(visibility.open.reshape(-1, 1), "u4"),
            "sights": _rows(sights, "u4"),
            "sight_index": _rows(index, "u4"),
            "corners": _rows(_four(corners.astype(np.uint32)), "u4"),
            "positions": _rows(_four(np.float32(vertices - middle)), "f4"),
            "normals": _rows(_four(normals), "f4"),
        },
        middle=middle,
        buffers=[
            (
                gl.buffer(np.float32(np.hstack([t.vertices - middle, t.normals])).tobytes()),
                gl.buffer(t.faces.astype(np.uint32).tobytes()),
            )
            for t in objects
        ],
        first_triangle=first_triangle,
        first_sight=np.searchsorted(sights[:, 0] & VERTEX, first_vertex).tolist(),
    )


def _sights(seen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sights (n, 2) uint32 by the vertex that is seen, and where to find them, (vertices SEEN², 1).

    A sight is an entry of `seen` with its coarse direction.
    """
    seen = seen.ravel()
    there = np.flatnonzero(seen != NOBODY)
    there = there[np.argsort(seen[there] & VERTEX, kind="stable")]
    index = np.full((len(seen), 1), NOBODY)
    index[there, 0] = np.arange(len(there), dtype=np.uint32)
    return np.stack([seen[there], (there % SEEN**2).astype(np.uint32)], axis=1), index


def _made(case: Case) -> tuple[list[Tessellation], Visibility]:
    objects = tessellate(case)
    return objects, bake(objects)


def local_radiance(
    geometry: SceneGeometry, shade: Callable[[int, Maps], tuple[moderngl.Program, dict, Maps]]
) -> moderngl.Texture:
    """The radiance of each sight, RGBA float16, row by row.

    Args:
        shade: for an object, the program local_radiance.frag with its uniforms and maps.
    """
    first = geometry.first_sight
    size = (ROW, max(-(-first[-1] // ROW), 1))
    gl = context()
    textures = [gl.texture(size, 4, dtype="f2") for _ in range(2)]
    targets = [gl.framebuffer([t]) for t in textures]
    for target in targets:
        target.clear()
    for bounce in range(BOUNCES):
        target, last = targets[bounce % 2], textures[(bounce + 1) % 2]
        for number in range(len(geometry.buffers)):
            program, uniforms, maps = shade(number)
            begin, end = first[number : number + 2]
            set_uniforms(program, **uniforms, sight_range=(begin, end))
            bind_maps(program, maps | geometry.maps | {"local_radiance": last})
            gl.enable_only(moderngl.NOTHING)
            rows = begin // ROW, -(-end // ROW)
            fill(target, program, (0, rows[0], ROW, max(rows[1] - rows[0], 1)))
    kept = (BOUNCES - 1) % 2
    release(*targets)
    textures[1 - kept].release()
    return textures[kept]


def _four(rows: np.ndarray) -> np.ndarray:
    """Rows (n, 3) with a fourth column of zeros."""
    return np.hstack([rows, np.zeros((len(rows), 1), rows.dtype)])


def _rows(values: np.ndarray, dtype: str, filler: int = 0) -> moderngl.Texture:
    """A texture ROW wide that holds values (n, components) one after the other."""
    height = max(-(-len(values) // ROW), 1)
    whole = np.full((height * ROW, values.shape[1]), filler, values.dtype)
    whole[: len(values)] = values
    texture = context().texture((ROW, height), values.shape[1], whole.tobytes(), dtype=dtype)
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    return texture
