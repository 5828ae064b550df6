"""Draw a case with a technique."""

from dataclasses import dataclass, replace
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from renderer.context import device
from renderer.grid import grid_of
from renderer.objects import culled, object_ids, placed, vertex_array
from renderer.passes import Draw, Prepared, draw_frame
from renderer.precompute import Precomputed, precomputed
from renderer.precompute.blurred import light_uniforms
from renderer.program import Maps, program
from renderer.shading import Shading
from renderer.targets import Rectangle, make_target, within
from renderer.techniques import Technique
from renderer.transport.exchange import exchange
from renderer.transport.placed import Placed, placed_meshes
from renderer.transport.received import received
from renderer.transport.scene import scene_geometry
from renderer.view import View, covered, view
from scenes.frame import Frame
from scenes.schema import Case, Object
from scenes.surface import plain

REPEATS = 5
RAY_OFFSET = 2e-5  # of the scene's size: how far rays start from their triangle
TIMING_SECONDS = 0.4  # slow techniques are timed over fewer frames


@dataclass(frozen=True, eq=False)
class Lit:
    """What light does in a case, wherever one looks from.

    Attributes:
        frame: uniforms of every pass.
        maps: of the environment, its materials, its geometry and the light there.
        seconds: that the tables of materials and the light between surfaces took.
    """

    shading: Shading
    geometry: Placed | None
    frame: dict[str, Any]
    maps: Maps
    seconds: float


@dataclass(frozen=True)
class Renderer:
    """The GLSL renderer with one technique; `render` meets the protocol of all renderers."""

    technique: Technique
    repeats: int = REPEATS

    def render(self, case: Case, part: Rectangle | None = None) -> Frame:
        """Draw the case as linear radiance, (H, W, 3) float32.

        A `part` of the picture (left, bottom, width, height in its pixels) shows what the whole
        shows there, so that a picture can be drawn in parts.

        `seconds` is the median of `repeats` warm frames (fewer if they are slow), from the first
        GL call to the end of glFinish, without read-back. Compilation, upload and precomputation
        stand apart in `provenance`.

        Raises:
            ValueError: the technique cannot draw the case's model or materials.
            InputError: a material's map cannot be used.
        """
        if what := self.technique.cannot_draw(case.model, [o.material for o in case.objects]):
            raise ValueError(f"'{self.technique.name}' cannot draw {what}")
        environment, read = self.environment(case)
        start = perf_counter()
        part = part or (0, 0, case.width, case.height)
        prepared = self.prepare(case, environment.maps, part)
        draw_frame(prepared)
        preparation = perf_counter() - start
        times = []
        while len(times) < self.repeats and sum(times) < TIMING_SECONDS:
            times.append(_timed(prepared))
        rgb, scale = prepared.target.read(), self.technique.supersample
        if scale > 1:
            rgb = rgb.reshape(part[3], scale, part[2], scale, 3).mean(axis=(1, 3))
        prepared.target.release()
        provenance = {
            "renderer": "shadeproof",
            "technique": self.technique.name,
            "device": device().name,
            "precomputation_seconds": environment.cost(read) + prepared.precomputation,
            "preparation_seconds": preparation - prepared.precomputation,
            "frame_seconds": times,
        }
        seconds = median(times) if times else preparation
        return Frame(np.ascontiguousarray(rgb), object_ids(case, part), seconds, provenance)

    def environment(self, case: Case) -> tuple[Precomputed, set[str]]:
        """A case's environment with every map that the technique reads, and their names."""
        environment = precomputed(case.environment.path)
        read = {m for o in case.objects for m in self.technique.maps(o.material, case.model)}
        environment.need(sorted(read))
        return environment, read

    def prepare(
        self, case: Case, maps: Maps, part: Rectangle | None = None, lit: Lit | None = None
    ) -> Prepared:
        """Compile (or find) the shaders, gather the uniforms and make the target.

        Args:
            lit: of a case that differs in its camera and size alone; made anew without.
        """
        lit = lit or self.light(case, maps)
        camera, geometry = view(case), lit.geometry
        scale = self.technique.supersample
        size = (case.width * scale, case.height * scale)
        part = tuple(scale * n for n in part or (0, 0, case.width, case.height))
        frame = lit.frame | {
            "forward": camera.forward,
            "right": camera.right,
            "up": camera.up,
            "picture_corner": part[:2],
            "picture_size": size,
        }
        how = self.technique
        if how.grid > 1:
            grid = grid_of(case.objects, camera, size, how.grid, how.msaa)
            how = replace(how, grid=grid)
        shading = replace(lit.shading, technique=how, case=case)
        if geometry:
            frame["eye"] = camera.eye - geometry.middle
        draws = [
            self._draw(obj, shading, camera, size, part, frame, lit.maps, geometry)
            for obj in case.objects
        ]
        around = covered(case.objects, camera, size)
        target = make_target(size, how.msaa, around, part, bool(geometry), how.grid)
        background = program("fullscreen.vert", "background.frag")
        rays = frame | {"pixel_area": _pixel_area(camera, case)}
        return Prepared(draws, background, rays, lit.maps, target, lit.seconds)

    def light(self, case: Case, maps: Maps) -> Lit:
        """What light does in a case, wherever one looks from: received, and exchanged."""
        how, turn = self.technique, case.environment.rotation / 360
        geometry = self._geometry(case)
        frame: dict[str, Any] = {"environment_turn": turn}
        if "lights_map" in how.reads:
            frame |= light_uniforms(maps["lights_map"], turn)
        shading = Shading(how, case, lit="light_count" in frame)
        maps, seconds = maps | shading.material_maps, shading.seconds
        if geometry:
            maps = maps | geometry.maps
        if how.occlusion:
            frame["ray_offset"] = RAY_OFFSET * geometry.size
            if how.interreflection:
                finely = [how.looks_finely(plain(o)) for o in case.objects]
                made = exchange(geometry, frame, maps, shading.any_material, finely)
            else:
                made = received(geometry, frame, maps, shading.any_material)
            maps, seconds = maps | made.maps, seconds + made.seconds
        return Lit(shading, geometry, frame, maps, seconds)

    def _geometry(self, case: Case) -> Placed | None:
        """The scene's triangles, baked, or as they are where a material varies over them."""
        if self.technique.occlusion:
            return scene_geometry(case)
        return placed_meshes(case) if any(o.material.varies for o in case.objects) else None

    def _draw(
        self,
        obj: Object,
        shading: Shading,
        camera: View,
        size: tuple[int, int],
        part: Rectangle,
        frame: dict[str, Any],
        maps: Maps,
        geometry: Placed | None,
    ) -> Draw:
        number = shading.case.index(obj.name)
        if geometry:
            raster, array, where = geometry.drawn(number - 1, camera)
        else:
            raster = program("mesh.vert", "surface.frag")
            array, where = vertex_array(obj.mesh, raster), placed(obj, camera)
        sides = {"ANTIALIASED"} if self.technique.msaa else set()
        sides |= {"PLACED"} if self.technique.occlusion or obj.material.varies else set()
        shader = shading.program(obj, frozenset(sides))
        uniforms = frame | where | shading.uniforms(obj) | {"number": number}
        maps = shading.maps(obj, maps)
        touched = within(covered((obj,), camera, size), part)
        turns = shading.turns(obj)
        return Draw(array, raster, shader, uniforms, maps, culled(obj, camera), touched, turns)


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
