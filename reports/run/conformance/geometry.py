"""From the mesh to the pixel: normals, and the filter at edges."""

from dataclasses import replace

import numpy as np
from scipy import ndimage

from renderer.context import context
from renderer.draw import Renderer
from renderer.objects import placed
from renderer.program import program, set_uniforms
from renderer.targets import release
from renderer.techniques import technique
from renderer.view import view
from reports.conformance.result import Conformance
from reports.run.conformance.shared import filled, measured, relative
from scenes.mesh import placement
from scenes.schema import Case

SMALL = 96  # pixels that edges are looked at with, of the picture's larger side
FINE = 4  # times as many, each way, are box-filtered by hand
DIRECTIONS = 1024  # at least, of a technique that samples: its noise is no edge
CONTRAST = 0.3  # around a pixel, of the brightest; below, an edge cannot be told
ENOUGH = 30  # pixels of edges


def of_edges(case: Case, name: str) -> Conformance | None:
    """How far a small picture is from 4x4 times its pixels averaged, at the edges of objects.

    The median, as a share of what a picture without a filter is off. None where there are too few
    edges, or for a technique that by its name does not filter: what it says of itself may be what
    is wrong.
    """
    if name.endswith(("-noaa", "-without-antialiasing")):
        return None
    how = technique(name).matched("unoccluded")  # whose edges against the sky are the same
    scale = SMALL / max(case.width, case.height)
    width, height = (max(round(side * scale), 1) for side in (case.width, case.height))
    small = case.model_copy(update={"width": width, "height": height})
    if how.samples:
        how = replace(how, samples=max(how.samples, DIRECTIONS))
    ways = how, replace(how, supersample=FINE, msaa=0), replace(how, msaa=0)
    frames = [Renderer(way, repeats=0).render(small) for way in ways]
    ours, theirs, without = (f.rgb.mean(axis=2, dtype=float) for f in frames)
    low, high = ndimage.minimum_filter(theirs, 3), ndimage.maximum_filter(theirs, 3)
    ids = frames[0].ids
    edge = (ndimage.minimum_filter(ids, 3) == 0) & (ndimage.maximum_filter(ids, 3) > 0)
    edge &= high - low > CONTRAST * high
    # Where a pixel is nearly wholly of one side any filter is about right.
    edge &= np.minimum(theirs - low, high - theirs) > 0.2 * (high - low)
    if edge.sum() < ENOUGH:
        return None
    contrast = (high - low)[edge]
    left, unfiltered = (np.median(np.abs(x - theirs)[edge] / contrast) for x in (ours, without))
    return measured("edges", left / max(unfiltered, 1e-30), f"{name} in {case.id}")


def of_normals(case: Case) -> Conformance:
    """Normals of one large triangle on a stretched and turned object, pixel by pixel.

    What interpolation does is next to nothing on a finely divided mesh, and all there is on a
    coarse one.
    """
    thing = case.objects[0].model_copy(
        update={"scale": (2.0, 0.5, 1.0), "rotate": (20.0, 30.0, 40.0), "height": None}
    )
    corners = np.float32([[-1, -1, 0], [3, -1, 0], [-1, 3, 0]])
    normals = np.float32([[0.6, 0, 0.8], [0, 1, 0], [-0.48, 0.6, 0.64]])
    shader, size = program("mesh.vert", "surface.frag"), (16, 16)
    whole = np.eye(4, dtype=np.float32).tobytes()
    set_uniforms(shader, **placed(thing, view(case)) | {"to_clip": whole, "number": 1.0})
    gl = context()
    vertices = gl.buffer(np.hstack([corners, normals]).tobytes())
    triangle = gl.vertex_array(shader, [(vertices, "3f 3f", "position", "normal")])
    ours = filled(triangle, size)[:, :3]
    release(triangle, vertices)
    y, x = (np.indices(size).reshape(2, -1) + 0.5) / 16 / 2  # barycentric; corners lie outside
    world = normals @ np.linalg.inv(placement(thing)[:3, :3])
    world /= np.linalg.norm(world, axis=1, keepdims=True)
    theirs = (1 - x - y)[:, None] * world[0] + x[:, None] * world[1] + y[:, None] * world[2]
    theirs /= np.linalg.norm(theirs, axis=1, keepdims=True)
    return measured("normals", relative(ours, theirs), "a stretched triangle")
