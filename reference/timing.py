"""How long one sample per pixel takes, the unit in which frame times are quoted, and a pilot."""

import statistics
import time

from scenes.schema import Case

RUNS = 7


def seconds_per_sample(case: Case) -> float:
    """Median wall time of one full picture at one sample per pixel by the stock path tracer.

    All pixels, through `mi.render`, warm, until the picture is in the caller's memory; the case's
    model as the materials.

    Raises:
        InputError: an input cannot be used, or there is no LLVM to run on.
    """
    from reference.scene_dict import build_scene, mi
    from reference.settings import PATH

    scene, _ = build_scene(case)
    integrator = mi.load_dict(PATH)
    times = []
    for seed in range(RUNS + 2):
        start = time.perf_counter()
        mi.render(scene, integrator=integrator, seed=seed, spp=1).numpy()
        times.append(time.perf_counter() - start)
    return statistics.median(times[2:])  # the first two compile and warm up


def pilot_seconds(case: Case) -> float:
    """Wall time of the pilot that a reference of the kind `model` starts with, warm."""
    from reference.truths import stage

    ready = stage(case, "model")
    times = []
    for _ in range(3):
        ready.__dict__.pop("control", None)  # a cached property
        start = time.perf_counter()
        ready.control  # noqa: B018  read to make it
        times.append(time.perf_counter() - start)
    return min(times)
