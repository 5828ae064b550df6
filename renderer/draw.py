"""Draw a case with a technique."""

from dataclasses import dataclass
from functools import cache
from statistics import median
from time import perf_counter
from typing import Any

import moderngl
import numpy as np

from renderer.context import context, device
from renderer.features import FINE, Technique, features, split_samples
from renderer.geometry import buffers
from renderer.precompute import Maps, precomputed
from renderer.precompute.brdf_table import smith_table
from renderer.precompute.prefilter import LEVELS
from renderer.program import bind_maps, fill, program, set_uniforms
from renderer.targets import Target, make_target, release
from renderer.view import View, inside, view
from scenes.frame import Frame
from scenes.mesh import load_mesh, placement
from scenes.schema import Case, Model, Object

REPEATS = 5
TIMING_SECONDS = 0.4  # slow techniques are timed over fewer frames


@dataclass(frozen=True, eq=False)
class Draw:
    """One object ready to be drawn: all that stays the same from frame to frame."""

    vertices: moderngl.VertexArray
    shader: moderngl.Program
    uniforms: dict[str, Any]
    maps: Maps
    culled: bool


@dataclass(frozen=True, eq=False)
class Prepared:
    """A case ready to be drawn again and again."""

    draws: list[Draw]
    background: moderngl.Program
    background_uniforms: dict[str, Any]
    maps: Maps
    target: Target


class Renderer:
    """The GLSL renderer with one technique; `render` meets the protocol of all renderers."""

    def __init__(self, technique: Technique, repeats: int = REPEATS) -> None:
        self.technique, self.repeats = technique, repeats

    def render(self, case: Case) -> Frame:
        """Draw the case as linear radiance, (H, W, 3) float32.

        `seconds` is the median of `repeats` warm frames (fewer if they are slow), from the first
        GL call to the end of glFinish, without read-back. Compilation, upload and precomputation
        stand apart in `provenance`.

        Raises:
            ValueError: the technique cannot draw the case's model.
        """
        if what := self.technique.cannot_draw(case.model):
            raise ValueError(f"'{self.technique.name}' cannot draw {what}")
        environment = precomputed(case.environment.path)
        read = {m for o in case.objects for m in self.technique.maps(o.material, case.model)}
        environment.need(sorted(read))
        tables = set()
        if self.technique.own_table(case.model):
            tables = {smith_table(o.material) for o in case.objects}
        start = perf_counter()
        prepared = self.prepare(case, environment.maps)
        draw_frame(prepared)
        preparation = perf_counter() - start
        times = []
        while len(times) < self.repeats and sum(times) < TIMING_SECONDS:
            times.append(_timed(prepared))
        rgb, scale = prepared.target.read(), self.technique.supersample
        if scale > 1:
            rgb = rgb.reshape(case.height, scale, case.width, scale, 3).mean(axis=(1, 3))
        prepared.target.release()
        provenance = {
            "renderer": "shadeproof",
            "technique": self.technique.name,
            "device": device().name,
            "precomputation_seconds": environment.cost(read) + sum(t.seconds for t in tables),
            "preparation_seconds": preparation,
            "frame_seconds": times,
        }
        seconds = median(times) if times else preparation
        return Frame(np.ascontiguousarray(rgb), object_ids(case), seconds, provenance)

    def prepare(self, case: Case, maps: Maps) -> Prepared:
        """Compile (or find) the shaders, gather the uniforms and make the target."""
        camera, turn = view(case), case.environment.rotation / 360
        draws = [self._draw(o, case.model, camera, turn, maps) for o in case.objects]
        background = program("fullscreen.vert", "background.frag")
        rays = {
            "forward": camera.forward,
            "right": camera.right,
            "up": camera.up,
            "environment_turn": turn,
            "pixel_area": _pixel_area(camera, case),
        }
        scale = self.technique.supersample
        target = make_target((case.width * scale, case.height * scale), self.technique.msaa)
        return Prepared(draws, background, rays, maps, target)

    def _draw(self, obj: Object, model: Model, camera: View, turn: float, maps: Maps) -> Draw:
        material = obj.material
        defines = features(material, model, self.technique.diffuse)
        shader = program("mesh.vert", "mesh.frag", defines, self.technique.shade)
        if self.technique.own_table(model):
            maps = maps | {"table_smith": smith_table(material).texture}
        uniforms = _placed(obj, camera) | {
            "albedo": material.diffuse_albedo,
            "f0": material.specular_f0,
            "alpha": material.alpha,
            "weight_d": (material.weight, 1 - material.weight),
            "weight_g": (material.masking_weight, 1 - material.masking_weight),
            "sharers": self.technique.supersample**2 if self.technique.filtered else 1e9,
            "lobe_samples": split_samples(material, self.technique.samples),
            "prefilter_levels": float(LEVELS),
            "environment_turn": turn,
        }
        maps = maps | {n: maps[f"{n}{FINE}"] for n in self.technique.fine if f"{n}{FINE}" in maps}
        vertices = vertex_array(obj.mesh, shader)
        return Draw(vertices, shader, uniforms, maps, _culled(obj, camera))


def draw_frame(prepared: Prepared) -> None:
    """One frame: objects, box filter over coverage, then the environment behind them."""
    gl, target = context(), prepared.target
    target.drawn.use()
    target.drawn.clear()
    for draw in prepared.draws:
        gl.enable_only(moderngl.DEPTH_TEST | (moderngl.CULL_FACE if draw.culled else 0))
        set_uniforms(draw.shader, **draw.uniforms)
        bind_maps(draw.shader, draw.maps)
        draw.vertices.render()
    if target.drawn is not target.resolved:
        gl.copy_framebuffer(target.resolved, target.drawn)
    gl.enable_only(moderngl.BLEND)
    gl.blend_func = moderngl.ONE_MINUS_DST_ALPHA, moderngl.ONE
    set_uniforms(prepared.background, **prepared.background_uniforms)
    bind_maps(prepared.background, prepared.maps)
    fill(target.resolved, prepared.background)
    gl.enable_only(moderngl.NOTHING)
    gl.finish()


def object_ids(case: Case) -> np.ndarray:
    """The object at each pixel's centre, (H, W) uint8, 1-based; 0 is the background."""
    gl, size = context(), (case.width, case.height)
    camera = view(case)
    shader = program("mesh.vert", "id.frag")
    target = gl.framebuffer([gl.renderbuffer(size, 1, dtype="u1")], gl.depth_renderbuffer(size))
    target.use()
    target.clear()
    for number, obj in enumerate(case.objects, start=1):
        cull = moderngl.CULL_FACE if _culled(obj, camera) else 0
        gl.enable_only(moderngl.DEPTH_TEST | cull)
        set_uniforms(shader, id=number, **_placed(obj, camera))
        vertex_array(obj.mesh, shader).render()
    gl.enable_only(moderngl.NOTHING)
    ids = np.frombuffer(target.read(components=1, dtype="u1"), np.uint8)
    release(target, *target.color_attachments, target.depth_attachment)
    return ids.reshape(case.height, case.width)[::-1].copy()


@cache
def vertex_array(mesh: str, shader: moderngl.Program) -> moderngl.VertexArray:
    """The mesh's shared buffers, bound to the inputs that the shader kept."""
    vertices, indices = buffers(mesh)
    layout = ("3f 3f", "position", "normal") if "normal" in shader else ("3f 12x", "position")
    return context().vertex_array(shader, [(vertices, *layout)], indices)


def _culled(obj: Object, camera: View) -> bool:
    """Whether the object's back faces are hidden for sure: it is closed and the eye outside."""
    return load_mesh(obj.mesh).closed and not inside(obj, camera.eye)


def _placed(obj: Object, camera: View) -> dict[str, Any]:
    """The uniforms that place an object, as column-major float32 bytes."""
    matrix = placement(obj)
    normals = np.linalg.inv(matrix[:3, :3])  # transposed twice: inverse transpose, column-major
    return {
        "to_clip": (camera.to_clip @ matrix).T.astype(np.float32).tobytes(),
        "to_world": matrix[:3].T.astype(np.float32).tobytes(),
        "normals_to_world": normals.astype(np.float32).tobytes(),
        "eye": camera.eye,
    }


def _pixel_area(camera: View, case: Case) -> float:
    """The area of a pixel on the image plane at distance 1."""
    return (
        4
        * float(np.linalg.norm(camera.right) * np.linalg.norm(camera.up))
        / (case.width * case.height)
    )


def _timed(prepared: Prepared) -> float:
    """Seconds for one warm frame."""
    start = perf_counter()
    draw_frame(prepared)
    return perf_counter() - start
