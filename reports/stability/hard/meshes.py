"""Hard meshes, and cameras that stand where they should not."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import trimesh

from reports.stability.hard.case import SAME, Hard, Make, twin
from reports.stability.hard.inputs import (
    AHEAD,
    COPPER,
    PLASTIC,
    lit,
    lump,
    sky,
    under_sky,
    write_ply,
)
from scenes.schema import Camera, Case

QUAD = np.array([(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)], float)
QUAD_FACES = np.array([(0, 1, 2), (0, 2, 3)])
EDGES = 0.01  # pixels whose centre an edge all but meets fall to either side


def mesh(
    vertices: np.ndarray, faces: np.ndarray, normals: np.ndarray | None = None, **fields
) -> Make:
    """A mesh of plastic under the ordinary map."""

    def make(folder: Path) -> Case:
        path = write_ply(folder, vertices, faces, normals)
        return lit(sky(folder), (path, PLASTIC, {}), **fields)

    return make


def scaled(factor: float) -> Make:
    """The lump in another unit, the camera with it."""
    vertices, faces = lump()
    camera = AHEAD.model_copy(update={"origin": (0.0, -4.0 * factor, 0.0)})
    return mesh(vertices * factor, faces, camera=camera)


def moved(middle: float, stored: bool) -> Make:
    """The lump and the camera far away, by the vertices in the file or by the object's position.

    Vertices of the file lie on the grid of float32 around `middle`, wherever they are stored.
    """
    vertices, faces = lump()
    vertices = np.float32(vertices + middle).astype(float) - middle
    camera = Camera(origin=(middle, middle - 4.0, middle), target=(middle,) * 3, fov=40)
    if stored:
        return mesh(vertices + middle, faces, camera=camera)

    def make(folder: Path) -> Case:
        path = write_ply(folder, vertices, faces)
        return lit(sky(folder), (path, PLASTIC, {"position": (middle,) * 3}), camera=camera)

    return make


def near(middle: float) -> Make:
    """The same lump at the origin."""
    vertices, faces = lump()
    return mesh(np.float32(vertices + middle).astype(float) - middle, faces)


def quad(camera: Camera | None = None, normals: np.ndarray | None = None, **fields) -> Make:
    """A square in the plane y = 0 that faces the ordinary camera."""
    return mesh(QUAD, QUAD_FACES, normals, camera=camera or AHEAD, **fields)


def sphere(**fields) -> Make:
    """A ball of copper, placed."""
    return under_sky(("sphere", COPPER, fields))


def _degenerate() -> tuple[np.ndarray, np.ndarray]:
    """The lump with triangles that are a point, a line, or a sliver."""
    vertices, faces = lump()
    middle = vertices[faces[:40]].mean(axis=1)
    a, b, c = faces[:40].T
    count = len(vertices)
    extra = np.concatenate(
        [
            np.stack([a, a, a], axis=1),
            np.stack([a, b, b], axis=1),
            np.stack([a, count + np.arange(40), a], axis=1),
            np.stack([c, b, c], axis=1),
        ]
    )
    return np.concatenate([vertices, middle]), np.concatenate([extra, faces])


def _split() -> tuple[np.ndarray, np.ndarray]:
    """The lump with three vertices of its own for every triangle, and every third one twice."""
    vertices, faces = lump()
    faces = np.concatenate([faces, faces[::3]])
    return vertices[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3)


def coincident(folder: Path, second: bool = True) -> Case:
    """Two surfaces of the same material in the same place, or one of them."""
    plane = ("plane", PLASTIC, {"scale": 4.0})
    camera = Camera(origin=(0.0, -4.0, 2.0), target=(0.0, 0.0, 0.0), fov=40)
    return lit(sky(folder), *(plane,) * (1 + second), camera=camera)


def rows() -> Iterator[Hard]:
    row = partial(Hard, kind="mesh")
    vertices, faces = lump()
    plain = mesh(vertices, faces)
    yield row(
        name="zero-area-triangles",
        must_hold="the picture is that of the mesh without them",
        why="their normal is 0/0",
        case=mesh(*_degenerate()),
        expect=twin(plain),
        silhouette=EDGES,
    )
    yield row(
        name="zero-area-triangles-with-normals",
        must_hold="the picture is that of the mesh without them",
        why="stored normals are kept, but those of points and lines lie beside the surface",
        case=mesh(*_degenerate(), np.vstack([_normals(), np.ones((40, 3))])),
        expect=twin(mesh(vertices, faces, _normals())),
        silhouette=EDGES,
    )
    for name, bad in (("zero", 0.0), ("nan", np.nan), ("inf", np.inf)):
        yield row(
            name=f"normals-{name}",
            must_hold="the picture is that of the mesh without stored normals",
            why="a normal of no length or no number has no direction",
            case=mesh(vertices, faces, np.full_like(vertices, bad)),
            expect=twin(plain if name != "zero" else mesh(vertices, faces, _first())),
            silhouette=EDGES,
        )
    yield row(
        name="one-normal-nan",
        must_hold="the picture is that of the mesh without stored normals",
        why="one NaN spreads over every triangle that shares the vertex",
        case=mesh(vertices, faces, _normals(broken=1)),
        expect=twin(plain),
    )
    yield row(
        name="normals-opposed",
        must_hold="no pixel is NaN where they cancel out",
        why="between opposite normals the interpolated one is 0, and 0/|0| is NaN",
        case=quad(
            AHEAD.model_copy(update={"fov": 30.0}),
            np.array([(1, 0, 0), (-1, 0, 0), (-1, 0, 0), (1, 0, 0)], float),
            size=(5, 9),
        ),
        silhouette=0.0,
    )
    yield row(
        name="normals-turned-away",
        must_hold="the picture is 0 where the surface is",
        why="a shading normal that faces away reflects nothing, in Mitsuba too",
        case=quad(normals=np.tile([0.0, 1.0, 0.0], (4, 1))),
        between=(0.0, 0.0),
        silhouette=EDGES,
    )
    yield row(
        name="normals-1e30-long",
        must_hold="the picture is that of unit normals",
        why="squares of 1e30 are Inf in float32",
        case=quad(normals=np.tile([0.0, -1e30, 0.0], (4, 1))),
        expect=twin(mesh(QUAD, QUAD_FACES, np.tile([0.0, -1.0, 0.0], (4, 1)))),
    )
    yield row(
        name="duplicates",
        must_hold="the picture is that of the mesh with each vertex and triangle once",
        why="triangles in the same place fight for each pixel; split vertices lose their normals",
        case=mesh(*_split()),
        expect=twin(plain),
        within=dict.fromkeys(SAME, 0.05),
        silhouette=EDGES,
    )
    yield row(
        name="winding-flipped",
        must_hold="the picture is that of the mesh wound as it should be",
        why="a closed mesh has an outside, whichever way its triangles are wound",
        case=mesh(vertices, faces[:, ::-1]),
        expect=twin(plain),
        silhouette=EDGES,
    )
    for factor in (1e6, 1e-6):
        yield row(
            name=f"coordinates-{factor:g}",
            must_hold="the picture does not depend on the unit of length",
            why="fixed epsilons are too small for the one and too large for the other",
            case=scaled(factor),
            expect=twin(scaled(1.0)),
            within=dict.fromkeys(SAME, 1e-3),
            silhouette=EDGES,
        )
    for name, stored in (("file", True), ("position", False)):
        yield row(
            name=f"1e6-away-by-{name}",
            must_hold="the picture is that of the same vertices at the origin",
            why="float32 keeps 1/16 of a unit there; sums must not lose more than the file did",
            case=moved(1e6, stored),
            expect=twin(near(1e6)),
            within=dict.fromkeys(SAME, 0.02),  # the file's last bits move some coverage samples
            silhouette=EDGES,
        )
    yield row(
        name="camera-inside",
        must_hold="the picture is exactly 0",
        why="the inner side of a closed surface reflects nothing, in Mitsuba too",
        case=under_sky(("sphere", COPPER, {"scale": 9.0})),
        between=(0.0, 0.0),
        silhouette=0.0,
    )
    yield row(
        name="camera-on-a-surface",
        must_hold="no pixel is NaN, Inf or negative",
        why="the distance to what is seen is 0",
        case=quad(Camera(origin=(0.0, 0.0, 0.0), target=(0.0, 1.0, 0.2), fov=60)),
        silhouette=0.0,
    )
    yield row(
        name="camera-along-a-surface",
        must_hold="nothing of the surface is seen",
        why="the surface projects to a line through the eye",
        case=quad(Camera(origin=(0.0, 0.0, 0.0), target=(0.0, 0.0, 1.0), up=(0, 1, 0), fov=60)),
        silhouette=0.0,
    )
    yield row(
        name="camera-at-a-vertex",
        must_hold="no pixel is NaN, Inf or negative",
        why="a vertex at the eye has no projection",
        case=quad(Camera(origin=(-1.0, 0.0, -1.0), target=(0.0, 0.5, 0.0), fov=60)),
        silhouette=EDGES,
    )
    yield row(
        name="triangles-edge-on",
        must_hold="nothing of the surface is seen",
        why="its projection has no area, and n.v is 0",
        case=quad(Camera(origin=(0.0, 0.0, 4.0), target=(0.0, 0.0, 0.0), up=(0, 1, 0), fov=60)),
        silhouette=0.0,
    )
    for name, position in (("behind", (0.0, -9.0, 0.0)), ("outside", (9.0, 0.0, 0.0))):
        yield row(
            name=f"object-{name}",
            must_hold="the picture is that of the environment with another object out of sight",
            why="what is not seen has an empty rectangle, or a projection of the wrong sign",
            case=sphere(position=position),
            expect=twin(sphere(position=(-50.0, 0.0, 0.0))),
            silhouette=0.0,
        )
    yield row(
        name="object-across-the-near-plane",
        must_hold="the floor is seen up to the horizon, and nothing of it above",
        why="triangles reach from before the eye to behind it",
        case=under_sky(("plane", PLASTIC, {"scale": 100.0, "position": (0.0, 0.0, -0.5)})),
        between=(0.01, 2.0),
        silhouette=EDGES,
    )
    yield row(
        name="coincident-surfaces",
        must_hold="the picture is that of one of them",
        why="which is in front is for rounding errors to say",
        case=coincident,
        silhouette=0.0,
        expect=twin(partial(coincident, second=False)),
    )
    for scale in (1e-16, 2e15):
        yield row(
            name=f"object-{scale:g}",
            must_hold="it is refused in one line",
            why="areas and squares of distances would leave float32 on either side",
            case=sphere(scale=scale),
            refused="keep sizes above",
        )
    yield row(
        name="vertices-nan",
        must_hold="it is refused in one line",
        why="a vertex that is no number is nowhere",
        case=mesh(np.where(vertices == vertices[7], np.nan, vertices), faces),
        refused="are NaN, Inf",
    )
    yield row(
        name="inside-out-with-normals",
        must_hold="the picture is that of the mesh with triangles and normals turned outwards",
        why="a closed mesh whose stored normals all point inwards would show black",
        case=mesh(vertices, faces[:, ::-1], -_normals()),
        expect=twin(mesh(vertices, faces, _normals())),
    )


def _normals(broken: int = 0) -> np.ndarray:
    """Unit normals of the lump's vertices, the first few NaN."""
    vertices, faces = lump()
    normals = np.array(trimesh.Trimesh(vertices, faces, process=False).vertex_normals)
    normals[:broken] = np.nan
    return normals


def _first() -> np.ndarray:
    """For each vertex of the lump the normal of the first triangle that has it."""
    vertices, faces = lump()
    shape = trimesh.Trimesh(vertices, faces, process=False)
    normals = np.empty_like(vertices)
    for face, normal in zip(faces[::-1], shape.face_normals[::-1], strict=True):
        normals[face] = normal
    return normals
