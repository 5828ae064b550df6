"""The truths, and the pixels they are traced for.

`unoccluded`: the case's model under the environment, without visibility.
`global`: the case's model with full light transport.
`physical`: Mitsuba's own materials with full light transport.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache

import drjit as dr
import numpy as np
from scipy.ndimage import binary_dilation

from reference.scene_dict import build_scene, camera_rays, shape_id
from reference.settings import PATH, SAMPLER, rounded_samples
from reference.variant import mitsuba
from scenes.schema import Case, Material
from scenes.suite import Truth

mi = mitsuba()

MAX_WAVEFRONT = 1 << 24  # samples in flight; bounds memory to about 2 GB
Radiance = Callable[[mi.Scene, mi.Sampler, mi.RayDifferential3f], mi.Color3f]


@dataclass(frozen=True, eq=False)
class Stage:
    """A case made ready for one truth.

    Attributes:
        traced: (H, W) bool, pixels that need path tracing.
        background: (H, W, 3) float32, the environment where `traced` is false, else 0.
        ids: (H, W) uint8, the object at each pixel's centre, 0 for none.
        notes: what could not be matched in the materials.
    """

    case: Case
    scene: mi.Scene
    radiance: Radiance
    traced: np.ndarray
    background: np.ndarray
    ids: np.ndarray
    notes: list[str]

    def trace(self, samples: int, seed: int) -> np.ndarray:
        """Path-trace the pixels that objects touch; the rest is the background.

        Args:
            samples: per pixel; `rounded_samples` of it are taken.

        Returns:
            (H, W, 3) float32, linear radiance.
        """
        samples = rounded_samples(samples)
        picture = self.background.copy()
        y, x = np.nonzero(self.traced)
        chunk = max(MAX_WAVEFRONT // samples, 1)
        for number, start in enumerate(range(0, len(x), chunk)):
            part = slice(start, start + chunk)
            corner = mi.Point2f(x[part].astype(np.float32), y[part].astype(np.float32))
            # Spread by the golden ratio, so that neighbouring seeds share no chunk.
            own_seed = (seed + number * 0x9E3779B9) % 2**32
            picture[y[part], x[part]] = self._trace_pixels(corner, samples, own_seed)
        return picture

    def _trace_pixels(self, corner: mi.Point2f, samples: int, seed: int) -> np.ndarray:
        """Mean radiance (n, 3) of pixels with upper left corners `corner`.

        The samples of a pixel lie next to each other, as the stratified samplers expect.
        """
        count = dr.width(corner) * samples
        sampler = mi.load_dict({"type": SAMPLER, "sample_count": samples})
        sampler.set_samples_per_wavefront(samples)
        sampler.seed(seed, count)
        pixel = dr.arange(mi.UInt32, count) // dr.opaque(mi.UInt32, samples)
        position = dr.gather(mi.Point2f, corner, pixel) + sampler.next_2d()
        L = self.radiance(self.scene, sampler, camera_rays(self.scene, self.case, position))
        return np.stack([dr.block_sum(c, samples).numpy() / samples for c in L], axis=1)


@lru_cache(maxsize=2)
def stage(case: Case, truth: Truth) -> Stage:
    """Build the scene of a case for a truth.

    Raises:
        InputError: an input cannot be used (see `build_scene`).
    """
    scene, notes = build_scene(case, physical=truth == "physical")
    radiance = unoccluded if truth == "unoccluded" else _path_tracer()
    traced, ids = covered(_bare(case))
    return Stage(case, scene, radiance, traced, _background(scene, case, ~traced), ids, notes)


@cache
def _path_tracer() -> Radiance:
    integrator = mi.load_dict(PATH)
    return lambda scene, sampler, ray: integrator.sample(scene, sampler, ray)[0]


def unoccluded(scene: mi.Scene, sampler: mi.Sampler, ray: mi.RayDifferential3f) -> mi.Color3f:
    """Environment light off the first surface hit, as if nothing stood in its way.

    One sample of the light and one of the BSDF, joined by the power heuristic (Veach 1997, 9.2.4).
    """
    light, context = scene.environment(), mi.BSDFContext()
    si = scene.ray_intersect(ray)
    hit = si.is_valid()
    bsdf = si.bsdf(ray)
    L = light.eval(si, ~hit)

    ds, weight = light.sample_direction(si, sampler.next_2d(), hit)
    f, density = bsdf.eval_pdf(context, si, si.to_local(ds.d), hit)
    L += f * weight * _power_heuristic(ds.pdf, density) & (hit & (ds.pdf > 0))

    bs, weight = bsdf.sample(context, si, sampler.next_1d(), sampler.next_2d(), hit)
    away, ds = dr.zeros(mi.SurfaceInteraction3f), dr.zeros(mi.DirectionSample3f)
    ds.d = si.to_world(bs.wo)
    away.wi = -ds.d
    heuristic = _power_heuristic(bs.pdf, light.pdf_direction(si, ds, hit))
    return L + (weight * light.eval(away, hit) * heuristic & (hit & (bs.pdf > 0)))


def _power_heuristic(own: mi.Float, other: mi.Float) -> mi.Float:
    return dr.square(own) / (dr.square(own) + dr.square(other))


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
