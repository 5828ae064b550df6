"""Draw a case with a technique."""

from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from renderer.context import device
from renderer.features import FINE, Technique, features, split_samples
from renderer.objects import culled, object_ids, placed, vertex_array
from renderer.passes import Draw, Prepared, draw_frame
from renderer.precompute import Maps, precomputed
from renderer.precompute.blurred import light_uniforms
from renderer.precompute.brdf_table import smith_table
from renderer.precompute.prefilter import LEVELS
from renderer.precompute.split import LAYERS
from renderer.program import program
from renderer.targets import Rectangle, make_target, within
from renderer.view import View, covered, view
from scenes.frame import Frame
from scenes.schema import Case, Model, Object

REPEATS = 5
TIMING_SECONDS = 0.4  # slow techniques are timed over fewer frames


class Renderer:
    """The GLSL renderer with one technique; `render` meets the protocol of all renderers."""

    def __init__(self, technique: Technique, repeats: int = REPEATS) -> None:
        self.technique, self.repeats = technique, repeats

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
        draws = [
            self._draw(number, obj, case.model, camera, size, part, frame, maps)
            for number, obj in enumerate(case.objects, start=1)
        ]
        target = make_target(size, self.technique.msaa, covered(case.objects, camera, size), part)
        background = program("fullscreen.vert", "background.frag")
        rays = frame | {"pixel_area": _pixel_area(camera, case)}
        return Prepared(draws, background, rays, maps, target)

    def _draw(
        self,
        number: int,
        obj: Object,
        model: Model,
        camera: View,
        size: tuple[int, int],
        part: Rectangle,
        frame: dict[str, Any],
        maps: Maps,
    ) -> Draw:
        material, how = obj.material, self.technique
        defines = features(material, model, how.diffuse, how.forced)
        lights = {}
        if "lights_map" in how.reads:
            lights = light_uniforms(maps["lights_map"], frame["environment_turn"])
            defines |= {"LIGHTS"} if lights else set()
        if how.own_table(model):
            maps = maps | {"table_smith": smith_table(material).texture}
        maps = maps | {n: maps[f"{n}{FINE}"] for n in how.fine if f"{n}{FINE}" in maps}
        raster = program("mesh.vert", "surface.frag")
        sides = frozenset({"ANTIALIASED"}) if how.msaa else frozenset()
        shading = program("fullscreen.vert", "surface_shade.frag", defines | sides, how.shade)
        uniforms = {
            **frame,
            **lights,
            **placed(obj, camera),
            "number": number,
            "albedo": material.diffuse_albedo,
            "f0": material.specular_f0,
            "alpha": material.alpha,
            "weight_d": (material.weight, 1 - material.weight),
            "weight_g": (material.masking_weight, 1 - material.masking_weight),
            "light_sharers": how.supersample**2 if how.filtered else 1e9,
            "set_samples": split_samples(material, how.samples_per_set),
            "pixel_samples": split_samples(material, how.samples_per_set * how.sets),
            "prefilter_levels": float(LEVELS),
            "lobe_layers": float(LAYERS),
            "coverage_samples": how.msaa,
        }
        vertices = vertex_array(obj.mesh, raster)
        touched = within(covered((obj,), camera, size), part)
        return Draw(vertices, raster, shading, uniforms, maps, culled(obj, camera), touched)


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
