"""The truths of a case made ready, and the pixels they are traced for.

A reference holds every truth that shares its paths:

    model      `unoccluded`, `direct` and `global`: the case's model, see reference.transport
    physical   `physical`: Mitsuba's own materials with full light transport
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache, partial

import drjit as dr
import numpy as np
import trimesh
from scipy.ndimage import binary_dilation

from reference.caustics import Caustics, caustics, from_the_lamps
from reference.scene_dict import build_scene, camera_rays, shape_id
from reference.settings import (
    LIGHT_PATHS,
    PILOT_SAMPLES,
    PILOT_SEED,
    SAMPLER,
    SPLIT,
    Kind,
    rounded_samples,
)
from reference.transport import Transport, model_light, openness, physical_light
from reference.variant import mitsuba
from scenes.mesh import world_mesh
from scenes.schema import Case, Material

mi = mitsuba()

MAX_WAVEFRONT = 1 << 24  # samples in flight; bounds memory to about 2 GB


@dataclass(frozen=True, eq=False)
class Stage:
    """A case made ready for one reference.

    Attributes:
        traced: (H, W) bool, pixels that need path tracing.
        caustics: what is traced from the lamps instead, if there is such light.
        background: (H, W, 3) float32, the environment where `traced` is false, else 0.
        ids: (H, W) uint8, the object at each pixel's centre, 0 for none.
        notes: what could not be matched in the materials.
    """

    case: Case
    scene: mi.Scene
    light: Transport
    caustics: Caustics | None
    traced: np.ndarray
    background: np.ndarray
    ids: np.ndarray
    notes: list[str]

    def trace(self, samples: int, seed: int) -> dict[str, np.ndarray]:
        """Path-trace the pixels that objects touch; the rest is the background.

        Args:
            samples: per pixel; `rounded_samples` of it are taken.

        Returns:
            By truth (H, W, 3) float32, linear radiance; by "<truth>.diffuse" the part of it off
            the first hit's diffuse lobe, 0 where nothing is traced.
        """
        pictures = {}
        for name, pixels in self._trace(self.light, samples, seed).items():
            still = self.background if "." not in name else np.zeros_like(self.background)
            pictures[name] = still.copy()
            pictures[name][self.traced] = pixels
        if self.caustics:
            self._add_caustics(pictures, samples, seed)
        return pictures

    def _add_caustics(self, pictures: dict[str, np.ndarray], samples: int, seed: int) -> None:
        """Add what light paths bring, LIGHT_PATHS for each path from the eye."""
        paths = int(self.traced.sum() * rounded_samples(samples) * LIGHT_PATHS)
        pieces = -(-paths // MAX_WAVEFRONT)
        name = "global" if "global" in pictures else "physical"
        for number in range(pieces):
            count, own_seed = -(-paths // pieces), _own(seed, number)
            found = from_the_lamps(self.caustics, self.scene, self.traced.shape, count, own_seed)
            for layer, light in zip((name, f"{name}.diffuse"), found, strict=True):
                pictures[layer][self.traced] += light[self.traced] / pieces

    @cached_property
    def control(self) -> np.ndarray:
        """The factor of the control variate at each traced pixel, (n,) float32.

        By the square of the share of directions that are open, from paths of its own: under a
        roof the unoccluded light says nothing, and its noise would only be added.
        """
        open_share = self._trace(openness, PILOT_SAMPLES, PILOT_SEED)["openness"][:, 0]
        return ((1 - 1 / SPLIT) * open_share**2).astype(np.float32)

    def _trace(self, light: Transport, samples: int, seed: int) -> dict[str, np.ndarray]:
        """Mean radiance (n, 3) of the traced pixels, by the names that `light` gives."""
        samples = rounded_samples(samples)
        y, x = np.nonzero(self.traced)
        if not len(x):  # no object is in sight: one pixel tells the names of what is traced
            corner, factor = mi.Point2f(0, 0), np.zeros(1, np.float32)
            named = self._trace_pixels(light, corner, factor, samples, seed)
            return {name: pixels[:0] for name, pixels in named.items()}
        control = self.control if light is not openness else np.zeros(len(x), np.float32)
        chunk, parts = max(MAX_WAVEFRONT // samples, 1), []
        for number, start in enumerate(range(0, len(x), chunk)):
            part = slice(start, start + chunk)
            corner = mi.Point2f(x[part].astype(np.float32), y[part].astype(np.float32))
            own_seed = _own(seed, number)
            parts.append(self._trace_pixels(light, corner, control[part], samples, own_seed))
        return {name: np.concatenate([p[name] for p in parts]) for name in parts[0]}

    def _trace_pixels(
        self, light: Transport, corner: mi.Point2f, control: np.ndarray, samples: int, seed: int
    ) -> dict[str, np.ndarray]:
        """Mean radiance (n, 3) of pixels with upper left corners `corner`.

        The samples of a pixel lie next to each other, as the stratified samplers expect.
        """
        count = dr.width(corner) * samples
        sampler = mi.load_dict({"type": SAMPLER, "sample_count": samples})
        sampler.set_samples_per_wavefront(samples)
        sampler.seed(seed, count)
        pixel = dr.arange(mi.UInt32, count) // dr.opaque(mi.UInt32, samples)
        position = dr.gather(mi.Point2f, corner, pixel) + sampler.next_2d()
        factor = dr.gather(mi.Float, mi.Float(control), pixel)
        ray = camera_rays(self.scene, self.case, position)
        L = light(self.scene, sampler, ray, factor, self.caustics)
        dr.eval(L)  # all at once: each alone would trace the paths anew
        return {
            name: np.stack([dr.block_sum(c, samples).numpy() / samples for c in colour], axis=1)
            for name, colour in L.items()
        }


def _own(seed: int, number: int) -> int:
    """The seed of a chunk, spread by the golden ratio: neighbouring seeds share no chunk."""
    return (seed + number * 0x9E3779B9) % 2**32


@lru_cache(maxsize=2)
def stage(case: Case, kind: Kind) -> Stage:
    """Build the scene of a case for a kind of reference.

    Raises:
        InputError: an input cannot be used (see `build_scene`).
    """
    scene, notes = build_scene(case, physical=kind == "physical")
    light = physical_light if kind == "physical" else model_light
    light = partial(light, alone=True) if nothing_occludes(case) else light
    traced, ids = covered(_bare(case))
    lamps, background = caustics(case, scene), _background(scene, case, ~traced)
    return Stage(case, scene, light, lamps, traced, background, ids, notes)


def nothing_occludes(case: Case) -> bool:
    """Whether no ray off the surface of a case can meet a surface again.

    So it is for one object alone that is flat or convex, if its normals are those of its faces:
    about an interpolated normal some directions lead into the surface, and count as occluded.
    """
    if len(case.objects) != 1:
        return False
    mesh = world_mesh(case.objects[0])
    shape = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    normals = shape.face_normals
    if not np.allclose(mesh.normals[mesh.faces], normals[:, None], atol=1e-4):
        return False
    size = np.ptp(mesh.vertices, axis=0).max()
    if np.allclose(normals, normals[0], atol=1e-4):
        return bool(np.ptp(mesh.vertices @ normals[0]) < 1e-5 * size)
    shape.merge_vertices(merge_norm=True)
    return mesh.closed and bool(shape.is_convex)


def _bare(case: Case) -> Case:
    """The case with one material for all, since coverage does not depend on materials."""
    grey = Material(albedo=(0, 0, 0), roughness=1, metallic=0)
    objects = tuple(o.model_copy(update={"material": grey}) for o in case.objects)
    return case.model_copy(update={"id": "", "objects": objects})


@lru_cache(maxsize=8)
def covered(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Which pixels objects touch, (H, W) bool, and the object at each centre, (H, W) uint8.

    A pixel counts if any ray of an 8x8 grid in it, or in a neighbour, hits.
    """
    scene = build_scene(case)[0]
    hit = np.zeros((case.height, case.width), bool)
    for row in range(8):
        for column in range(8):
            ray = camera_rays(scene, case, _pixels(case) + mi.Point2f(column + 0.5, row + 0.5) / 8)
            hit |= scene.ray_test(ray).numpy().reshape(hit.shape)
    grown = binary_dilation(hit, np.ones((3, 3)))

    found = scene.ray_intersect_preliminary(camera_rays(scene, case, _pixels(case) + 0.5))
    shapes = {shape.id(): shape for shape in scene.shapes()}
    ids = mi.UInt32(0)
    for number in range(len(case.objects)):
        ids = dr.select(found.shape == mi.ShapePtr(shapes[shape_id(number)]), number + 1, ids)
    return grown, ids.numpy().astype(np.uint8).reshape(hit.shape)


def _pixels(case: Case) -> mi.Point2f:
    """The upper left corner of every pixel, row by row."""
    index = dr.arange(mi.UInt32, case.width * case.height)
    return mi.Point2f(index % case.width, index // case.width)


def _background(scene: mi.Scene, case: Case, where: np.ndarray) -> np.ndarray:
    """The environment, averaged over a 4x4 grid in each pixel and so without noise; 0 elsewhere."""
    total = mi.Color3f(0)
    si = dr.zeros(mi.SurfaceInteraction3f)
    for row in range(4):
        for column in range(4):
            ray = camera_rays(scene, case, _pixels(case) + mi.Point2f(column + 0.5, row + 0.5) / 4)
            si.wi = -ray.d
            total += scene.environment().eval(si)
    picture = (total / 16).numpy().T.reshape(case.height, case.width, 3)
    return np.where(where[..., None], picture, 0).astype(np.float32)
