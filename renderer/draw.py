"""Draw a case with a technique."""

from dataclasses import dataclass
from statistics import median
from time import perf_counter
from typing import Any

import moderngl
import numpy as np

from renderer.context import context, device
from renderer.features import FINE, Technique, features, split_samples
from renderer.objects import culled, object_ids, placed, placed_in_world, vertex_array
from renderer.passes import Draw, Prepared, draw_frame
from renderer.precompute import precomputed
from renderer.precompute.blurred import light_uniforms
from renderer.precompute.brdf_table import smith_table
from renderer.precompute.prefilter import LEVELS
from renderer.program import Maps, program
from renderer.targets import Rectangle, make_target, within
from renderer.transport.exchange import exchange
from renderer.transport.scene import SceneGeometry, scene_geometry
from renderer.view import View, covered, view
from scenes.frame import Frame
from scenes.schema import Case, Material, Model, Object

REPEATS = 5
RAY_OFFSET = 2e-5  # of the scene's size: how far rays start from their triangle
TIMING_SECONDS = 0.4  # slow techniques are timed over fewer frames


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
            "precomputation_seconds": environment.cost(read) + sum(t.seconds for t in tables),
            "preparation_seconds": preparation,
            "frame_seconds": times,
        }
        seconds = median(times) if times else preparation
        return Frame(np.ascontiguousarray(rgb), object_ids(case, part), seconds, provenance)

    def prepare(self, case: Case, maps: Maps, part: Rectangle | None = None) -> Prepared:
        """Compile (or find) the shaders, gather the uniforms and make the target."""
        camera, turn = view(case), case.environment.rotation / 360
        geometry = scene_geometry(case) if self.technique.occlusion else None
        scale = self.technique.supersample
        size = (case.width * scale, case.height * scale)
        part = tuple(scale * n for n in part or (0, 0, case.width, case.height))
        frame = {
            "forward": camera.forward,
            "right": camera.right,
            "up": camera.up,
            "environment_turn": turn,
            "picture_corner": part[:2],
            "picture_size": size,
        }
        if "lights_map" in self.technique.reads:
            frame |= light_uniforms(maps["lights_map"], turn)
        if geometry:
            maps = maps | geometry.maps
            frame |= {
                "eye": camera.eye - geometry.middle,
                "ray_offset": RAY_OFFSET * geometry.size,
            }
        if self.technique.interreflection:
            start = perf_counter()
            maps = maps | self._exchanged(case, geometry, frame, maps)
            context().finish()
            print("exchange", perf_counter() - start, geometry.vertices, geometry.sights)
        draws = [
            self._draw(number, obj, case, camera, size, part, frame, maps, geometry)
            for number, obj in enumerate(case.objects, start=1)
        ]
        around = covered(case.objects, camera, size)
        target = make_target(size, self.technique.msaa, around, part, placed=bool(geometry))
        background = program("fullscreen.vert", "background.frag")
        rays = frame | {"pixel_area": _pixel_area(camera, case)}
        return Prepared(draws, background, rays, maps, target)

    def _draw(
        self,
        number: int,
        obj: Object,
        case: Case,
        camera: View,
        size: tuple[int, int],
        part: Rectangle,
        frame: dict[str, Any],
        maps: Maps,
        geometry: SceneGeometry | None,
    ) -> Draw:
        how = self.technique
        maps = self._read(obj.material, case.model, maps)
        sides = {"ANTIALIASED"} if how.msaa else set()
        if geometry:
            sides.add("PLACED")
            raster = program("placed.vert", "surface.frag", frozenset({"PLACED"}))
            vertices, indices = geometry.buffers[number - 1]
            layout = (vertices, "3f 3f", "position", "normal")
            array = context().vertex_array(raster, [layout], indices)
            where = placed_in_world(geometry.middle, camera)
            where |= {"first_triangle": geometry.first_triangle[number - 1]}
        else:
            raster = program("mesh.vert", "surface.frag")
            array, where = vertex_array(obj.mesh, raster), placed(obj, camera)
        shading = self._shading(obj.material, case, frozenset(sides) | _lights(frame))
        uniforms = frame | where | self._uniforms(obj.material) | {"number": number}
        touched = within(covered((obj,), camera, size), part)
        return Draw(array, raster, shading, uniforms, maps, culled(obj, camera), touched)

    def _exchanged(
        self, case: Case, geometry: SceneGeometry, frame: dict[str, Any], maps: Maps
    ) -> Maps:
        """What the scene's surfaces send one another, with their materials."""
        rows = [
            [*m.diffuse_albedo, m.alpha, *m.specular_f0, m.weight, m.masking_weight, 0, 0, 0]
            for m in (o.material for o in case.objects)
        ]
        data = np.array(rows, np.float32).tobytes()
        materials = context().texture((3, len(rows)), 4, data, dtype="f4")
        maps = maps | {"materials": materials}
        made = exchange(geometry, frame, maps, self._union(case) | _lights(frame))
        return made | {"materials": materials}

    def _union(self, case: Case) -> frozenset[str]:
        """The features that any object needs, for what may reflect any of them."""
        every = (features(o.material, case.model, self.technique.diffuse) for o in case.objects)
        return frozenset({"INTERREFLECTION"}).union(*every)

    def _shading(self, material: Material, case: Case, sides: frozenset[str]) -> moderngl.Program:
        how = self.technique
        defines = features(material, case.model, how.diffuse, how.forced) | sides
        incoming = how.incoming(material)
        if how.interreflection:
            reflects_any = incoming == "incoming_traced.glsl"
            defines |= self._union(case) if reflects_any else {"INTERREFLECTION"}
        return program("fullscreen.vert", "surface_shade.frag", defines, how.shade, incoming)

    def _read(self, material: Material, model: Model, maps: Maps) -> Maps:
        """The maps that shading a material reads."""
        how = self.technique
        if how.own_table(model):
            maps = maps | {"table_smith": smith_table(material).texture}
        return maps | {n: maps[f"{n}{FINE}"] for n in how.fine if f"{n}{FINE}" in maps}

    def _uniforms(self, material: Material) -> dict[str, Any]:
        how = self.technique
        return {
            "albedo": material.diffuse_albedo,
            "f0": material.specular_f0,
            "alpha": material.alpha,
            "weight_d": (material.weight, 1 - material.weight),
            "weight_g": (material.masking_weight, 1 - material.masking_weight),
            "light_sharers": how.supersample**2 if how.filtered else 1e9,
            "set_samples": split_samples(material, how.per_set(material)),
            "pixel_samples": split_samples(material, how.per_set(material) * how.sets),
            "prefilter_levels": float(LEVELS),
            "coverage_samples": how.msaa,
        }


def _lights(frame: dict[str, Any]) -> frozenset[str]:
    """The feature that shades lights, where the environment has any."""
    return frozenset({"LIGHTS"} if "light_count" in frame else ())


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
