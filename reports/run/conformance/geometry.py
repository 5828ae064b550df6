"""Normals, from the mesh to the pixel."""

import numpy as np

from renderer.context import context
from renderer.objects import placed
from renderer.program import program, set_uniforms
from renderer.targets import release
from renderer.view import view
from reports.conformance.result import Conformance
from reports.run.conformance.shared import filled, measured, relative
from scenes.mesh import placement
from scenes.schema import Case


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
