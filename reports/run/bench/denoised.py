"""Mitsuba followed by Intel's Open Image Denoise, guided by albedo and shading normals.

The guides come from the paths' first hits, in the same render, at 1.2 times its time. Mitsuba's own
integrator `aov` would take twice the time, and its albedo of a metal is the BRDF at one direction
times pi: from .0006 to 1,850 on silver, where the denoiser expects 0 to 1. So the albedo is what
its documentation asks for, the reflectance at normal incidence.

These guides have noise only at edges, and `clean_aux` says that they have none, as is recommended
for such. Measured on one bunny at 256x256 in the courtyard, SSIM at 4 samples without
guides, with guides, and with clean ones: .884 .895 .902 copper, .921 .915 .920 silver, .928 .938
.951 red plastic; at 64 .974 .981 .982, .983 .983 .984, .967 .987 .989. Filtering the guides first
gains .010 at 1 sample and .001 at 4, and takes two more runs of the denoiser.
"""

import drjit as dr
import numpy as np

from reference.scene_dict import mi, shape_id
from reference.settings import PATH
from reports.run.bench.path_traced import PathTraced, Tracer
from scenes.schema import Case, Object

EXTRA = "pip install 'shadeproof[denoise]'"


def unavailable() -> str:
    """Why nothing can be denoised here, or nothing."""
    try:
        import mitsuba_oidn  # noqa: F401  asked for only to see whether it can be
    except ImportError as error:
        first = " ".join(str(error).split())
        return f"denoised: mitsuba-oidn cannot be imported ({first}); {EXTRA}"
    return ""


def reflectance(obj: Object) -> list[float]:
    """How bright a surface is whatever the light: diffuse albedo and F0, (3,), at most 1."""
    material = obj.material
    pairs = zip(material.diffuse_albedo, material.specular_f0, strict=True)
    return [min(a + f, 1.0) for a, f in pairs]


class Guides(mi.SamplingIntegrator):
    """The path tracer with two guides of each path's first hit: albedo (3) and normal (3)."""

    def __init__(self, props: mi.Properties) -> None:
        super().__init__(props)
        self.path = mi.load_dict(PATH)
        self.colours: dict[str, list[float]] = {}  # of the shapes, by their ids

    def sample(self, scene, sampler, ray, medium=None, active=True):
        L, valid, _ = self.path.sample(scene, sampler, ray, medium, active)
        hit = scene.ray_intersect(mi.Ray3f(ray), active)
        albedo = mi.Color3f(0)
        for shape in scene.shapes():
            colour = mi.Color3f(self.colours[shape.id()])
            albedo = dr.select(hit.shape == mi.ShapePtr(shape), colour, albedo)
        normal = dr.select(hit.is_valid(), hit.sh_frame.n, 0)
        return L, valid, [*albedo, *normal]

    def aov_names(self):
        return [f"albedo.{c}" for c in "RGB"] + [f"normal.{c}" for c in "XYZ"]


mi.register_integrator("guides", Guides)


class DenoisedTracer(Tracer):
    """Pictures that are path-traced with their guides, then denoised."""

    def __init__(self, case: Case) -> None:
        super().__init__(case)
        numbered = enumerate(case.objects)
        self.integrator.colours = {shape_id(n): reflectance(obj) for n, obj in numbered}

    def method(self) -> dict:
        return {"type": "guides"}

    def draw(self, samples: int, seed: int) -> np.ndarray:
        import mitsuba_oidn

        traced = self.traced(samples, seed)
        colour, albedo, normal = (mi.TensorXf(traced[..., n : n + 3]) for n in (0, 3, 6))
        shown = mitsuba_oidn.denoise(colour, albedo, normal, hdr=True, clean_aux=True)
        return shown.numpy()


class Denoised(PathTraced):
    """The path tracer at some samples per pixel, and the denoiser after it."""

    family = "denoised"
    label = "Mitsuba {} + OIDN"
