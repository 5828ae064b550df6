"""Objects on the GPU: where they stand, how they are drawn, and which pixels are theirs."""

import math
from functools import cache
from typing import Any

import moderngl
import numpy as np
from trimesh.transformations import translation_matrix

from renderer.context import context
from renderer.geometry import buffers, middle
from renderer.program import program, set_uniforms
from renderer.targets import Rectangle, release
from renderer.view import View, inside, view
from scenes.mesh import load_mesh, placement
from scenes.schema import Case, Object


@cache
def vertex_array(mesh: str, shader: moderngl.Program) -> moderngl.VertexArray:
    """The mesh's shared buffers, bound to the inputs that the shader kept."""
    vertices, indices = buffers(mesh)
    layout = ("3f 3f", "position", "normal") if "normal" in shader else ("3f 12x", "position")
    return context().vertex_array(shader, [(vertices, *layout)], indices)


def placed(obj: Object, camera: View) -> dict[str, Any]:
    """The uniforms that place an object, as column-major float32 bytes."""
    matrix = placement(obj)
    centred = matrix @ translation_matrix(middle(obj.mesh))
    normals = np.linalg.inv(matrix[:3, :3])  # transposed twice: inverse transpose, column-major
    # Near 1, whatever the object's size: squares of 1e20 leave float32. Powers of 2 lose no bits.
    normals *= 2.0 ** -math.frexp(np.abs(normals).max())[1]
    return {
        "to_clip": (camera.to_clip @ centred).T.astype(np.float32).tobytes(),
        "normals_to_world": normals.astype(np.float32).tobytes(),
    }


def placed_in_world(middle: np.ndarray, camera: View) -> dict[str, Any]:
    """The uniform that shows what stands in world space already, from its middle (3,)."""
    return {"to_clip": (camera.to_clip @ translation_matrix(middle)).T.astype(np.float32).tobytes()}


def culled(obj: Object, camera: View) -> bool:
    """Whether the object's back faces are hidden for sure: it is closed and the eye outside."""
    return load_mesh(obj.mesh).closed and not inside(obj, camera.eye)


def object_ids(case: Case, part: Rectangle | None = None) -> np.ndarray:
    """The object at each pixel's centre, (H, W) uint8, 1-based; 0 is the background.

    Args:
        part: left, bottom, width and height of the pixels to draw; None for all.
    """
    left, bottom, *size = part or (0, 0, case.width, case.height)
    gl = context()
    camera = view(case)
    shader = program("mesh.vert", "id.frag")
    target = gl.framebuffer([gl.renderbuffer(size, 1, dtype="u1")], gl.depth_renderbuffer(size))
    target.clear()
    target.viewport = (-left, -bottom, case.width, case.height)
    target.use()
    for number, obj in enumerate(case.objects, start=1):
        cull = moderngl.CULL_FACE if culled(obj, camera) else 0
        gl.enable_only(moderngl.DEPTH_TEST | cull)
        set_uniforms(shader, id=number, **placed(obj, camera))
        vertex_array(obj.mesh, shader).render()
    gl.enable_only(moderngl.NOTHING)
    ids = np.frombuffer(target.read(components=1, dtype="u1"), np.uint8)
    release(target, *target.color_attachments, target.depth_attachment)
    return ids.reshape(size[1], size[0])[::-1].copy()
