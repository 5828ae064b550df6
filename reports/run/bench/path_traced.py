"""Mitsuba as a user would run it: the stock path tracer on the case's model, sampler at its best.

The sampler is `multijitter`. Measured once on one bunny at 256x256 in the courtyard, beside
`independent` at the same samples: at 64 the squared local energy error is 2.0, 1.3 and 3.2 times
smaller (copper, silver, red plastic) and 1 - SSIM 1.5, 1.3 and 2.0 times, and a picture takes 1.00
to 1.07 times as long (at 16, medians of 15 pairs in turn). So the square falls faster than 1 / k,
and the law that is fitted has its exponent free.
"""

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from time import perf_counter

import drjit as dr
import numpy as np

from reference.scene_dict import build_scene, mi, sensor, shape_id
from reference.settings import PATH
from reports.run.bench import kernels
from reports.run.bench.memory import growing
from reports.run.bench.way import Cost, Way, changed
from reports.speed.points import Change
from scenes.schema import Case

SAMPLER = "multijitter"
# Those for which `multijitter` takes no other number: products of two near-equal integers.
SAMPLES = (1, 2, 4, 8, 16, 36, 64, 144, 256)
MOST_PATHS = 1 << 24  # a picture: 256 samples at 256x256, 8 at 1920x1080
REPEATS = 3


def samples_for(case: Case) -> list[int]:
    """The samples per pixel that are worth their time at the case's size; at least two."""
    most = max(MOST_PATHS // (case.width * case.height), SAMPLES[1])
    return [k for k in SAMPLES if k <= most]


class Tracer:
    """A case's scene, and pictures of it at any samples per pixel."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.scene, _ = build_scene(case)
        self.integrator = mi.load_dict(self.method())
        box, eye = self.scene.bbox(), np.array(case.camera.origin)
        reach = np.linalg.norm(
            np.maximum(abs(np.array(box.min) - eye), abs(np.array(box.max) - eye))
        )
        view = sensor(case.camera, case.width, case.height, float(reach))
        self.sensor = mi.load_dict(view | {"sampler": {"type": SAMPLER, "sample_count": 1}})

    def method(self) -> dict:
        """The integrator as a Mitsuba dictionary."""
        return PATH

    def traced(self, samples: int, seed: int) -> "mi.TensorXf":
        """A picture (H, W, channels), still with Dr.Jit."""
        return mi.render(
            self.scene, sensor=self.sensor, integrator=self.integrator, seed=seed, spp=samples
        )

    def draw(self, samples: int, seed: int) -> np.ndarray:
        """A picture (H, W, 3) in the caller's memory."""
        return self.traced(samples, seed).numpy()

    def seconds(self, samples: int = SAMPLES[0]) -> float:
        """Of one picture."""
        start = perf_counter()
        self.draw(samples, 0)
        return perf_counter() - start


@dataclass(frozen=True)
class Start:
    """A tracer that was started without any kernel compiled, and what that took.

    Attributes:
        preparation: seconds for the scene and its BVH, from meshes and light that are decoded.
        compilation: seconds that the first picture takes more than later ones.
        further: seconds that a picture takes more once a thing has changed.
        left: bytes that stay.
    """

    tracer: Tracer
    preparation: float
    compilation: float
    further: dict[Change, float]
    left: float


def started(
    make: Callable[[Case], Tracer], case: Case, further: dict[Change, float] | None = None
) -> Start:
    """Start a tracer on a case and measure that, with the costs of changes if they are not known.

    A denoiser adds nothing to those: they come before the first ray.
    """
    kernels.forget()
    dr.flush_malloc_cache()
    with growing() as growth:
        start = perf_counter()
        tracer = make(case)
        dr.sync_thread()
        preparation = perf_counter() - start
        first = tracer.seconds()
        warm = median(tracer.seconds() for _ in range(REPEATS))
        dr.flush_malloc_cache()
    if further is None:
        further = changes(make, case)
    return Start(tracer, preparation, max(first - warm, 0.0), further, growth.left)


def changes(make: Callable[[Case], Tracer], case: Case) -> dict[Change, float]:
    """Seconds that a picture takes more once a thing has changed, by setting parameters.

    What is set is opaque to Dr.Jit, or each new number would be compiled anew. The scene holds
    both lobes already: at the ends of the weight one is compiled out.
    """
    tracer = make(changed(case, "weight"))
    for seed in range(2):
        tracer.draw(SAMPLES[0], seed)
    found: dict[Change, float] = {}
    for change in ("light", "material", "weight", "geometry"):
        more = []
        for step in range(1, 1 + REPEATS):
            new = _new_parameters(tracer, change, step)
            params, warm = mi.traverse(tracer.scene), tracer.seconds()
            start = perf_counter()
            for name, value in new.items():
                params[name] = value
            params.update()
            tracer.draw(SAMPLES[0], 0)
            more.append(perf_counter() - start - warm)
        found[change] = max(median(more), 0.0)
    return found


def _new_parameters(tracer: Tracer, change: Change, step: int) -> dict[str, object]:
    """What to set on a scene for a change, as a user has it before: numbers and arrays."""
    params, new = mi.traverse(tracer.scene), {}
    if change == "light":
        light = "environment.data"
        return {light: mi.TensorXf(params[light].numpy() * np.float32(1 + step / 8))}
    case = changed(tracer.case, change, step) if change != "geometry" else tracer.case
    for number, obj in enumerate(case.objects):
        name, material = shape_id(number), obj.material
        if change == "geometry":
            places = f"{name}.vertex_positions"
            new[places] = mi.Float(params[places].numpy() * np.float32(1 + step / 1024))
        elif change == "weight":
            new[f"{name}.bsdf.weight"] = dr.opaque(mi.Float, material.weight)
            new[f"{name}.bsdf.weight_g"] = dr.opaque(mi.Float, material.masking_weight)
        else:
            albedo = [dr.opaque(mi.Float, a) for a in material.diffuse_albedo]
            new[f"{name}.bsdf.alpha"] = dr.opaque(mi.Float, material.alpha)
            new[f"{name}.bsdf.albedo"] = mi.Color3f(albedo)
    return new


class PathTraced(Way):
    """A path tracer at some samples per pixel."""

    family, noisy = "path traced", True
    label = "Mitsuba {}"

    def __init__(self, start: Start, samples: int) -> None:
        self.start, self.samples, self.name = start, samples, self.label.format(samples)

    def frame(self, seed: int) -> float:
        """Seconds until the picture is in the caller's memory."""
        start = perf_counter()
        self.last = self.start.tracer.draw(self.samples, seed)
        return perf_counter() - start

    def picture(self) -> np.ndarray:
        return self.last

    def cost(self, frame: float) -> Cost:
        dr.flush_malloc_cache()
        with growing() as growth:
            self.start.tracer.draw(self.samples, 0)
        once = self.start
        return Cost(
            compilation=once.compilation,
            preparation=once.preparation,
            after={change: frame + seconds for change, seconds in once.further.items()},
            memory=once.left + growth.peak,
        )
