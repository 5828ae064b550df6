"""The plain way to a reference, to tell what ours saves: every pixel, independent samples."""

import time

import drjit as dr
import numpy as np

from reference.scene_dict import build_scene, camera_rays, mi
from reference.settings import PATH
from reference.transport import unoccluded
from scenes.frame import Frame
from scenes.schema import Case

SAMPLER = {"type": "independent"}
# Mitsuba's own integrators; for unoccluded light it has none.
INTEGRATORS = {"global": PATH, "direct": {"type": "direct"}}


def plain_batches(case: Case, truth: str, samples: int, count: int) -> list[Frame]:
    """Batches of one truth as Mitsuba gives them: the whole picture, `independent` samples.

    Args:
        truth: `global` and `direct` are Mitsuba's own integrators, through `mi.render`;
            `unoccluded` is one sample of the light and one of the BSDF a path, as in these.

    Returns:
        Frames without ids; `seconds` is warm, until the picture is in the caller's memory.

    Raises:
        InputError: an input cannot be used, or there is no LLVM to run on.
    """
    scene, _ = build_scene(case)  # its sensor has Mitsuba's default sampler, which is SAMPLER
    integrator = mi.load_dict(INTEGRATORS[truth]) if truth in INTEGRATORS else None
    frames = []
    for seed in range(count + 1):
        start = time.perf_counter()
        if integrator is None:
            picture = _unoccluded(scene, case, samples, seed)
        else:
            picture = mi.render(scene, integrator=integrator, seed=seed, spp=samples).numpy()
        frames.append(Frame(picture, seconds=time.perf_counter() - start))
    return frames[1:]  # the first compiles and warms up


def _unoccluded(scene: mi.Scene, case: Case, samples: int, seed: int) -> np.ndarray:
    """The picture without visibility, (H, W, 3)."""
    count = case.width * case.height * samples
    sampler = mi.load_dict(SAMPLER)
    sampler.seed(seed, count)
    pixel = dr.arange(mi.UInt32, count) // dr.opaque(mi.UInt32, samples)
    corner = mi.Point2f(pixel % case.width, pixel // case.width)
    ray = camera_rays(scene, case, corner + sampler.next_2d())
    L = unoccluded(scene, sampler, ray)
    dr.eval(L)
    means = [dr.block_sum(c, samples).numpy() / samples for c in L]
    return np.stack(means, axis=1).reshape(case.height, case.width, 3)
