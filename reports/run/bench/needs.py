"""What a case does without, with the proof: the same frame with it on, and the time it would take.

Features are compiled in only where a material needs them, and maps made only where a feature reads
them. Here each is switched on although nothing needs it.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from time import perf_counter

import numpy as np

from renderer.context import context
from renderer.draw import Renderer
from renderer.features import LOBES, Feature
from renderer.glsl import source
from renderer.passes import Prepared, draw_frame
from renderer.precompute import Precomputed, precomputed
from renderer.techniques import Technique, technique
from reports.noise import quantile
from reports.run.bench.measured import timed
from reports.speed.points import LeftOut
from scenes.schema import Case

FRAMES = 9  # of each of a pair, in turns
MAKINGS = 3  # of maps
SAME = 1e-6  # relMSE up to which two frames are one: what is left is rounding
REFERENCE_SAMPLES = 16  # of each of the batches that prove a reference's rays needless
SAMPLES = 4  # coverage samples that a technique without antialiasing leaves out

MAPS = {
    "irradiance_map": "irradiance map",
    "prefiltered_ggx": "environment prefiltered for GGX",
    "prefiltered_beckmann": "environment prefiltered for Beckmann",
}
PREFILTERED = ("prefiltered_ggx", "prefiltered_beckmann")
WORDS = {
    "D_GGX": ("GGX lobe", "its weight is 0"),
    "D_BECKMANN": ("Beckmann lobe", "its weight is 0"),
    "G_GGX": ("masking of GGX", "its weight is 0"),
    "G_BECKMANN": ("masking of Beckmann", "its weight is 0"),
    "DIFFUSE": ("diffuse lobe", "its albedo is 0"),
}


def left_out(case: Case, techniques: tuple[str, ...]) -> list[LeftOut]:
    """What a case does without, for one technique of each way to shade: that of fewest samples."""
    ways: dict[str, Technique] = {}
    for how in sorted(map(technique, techniques), key=lambda t: t.samples):
        ways.setdefault(how.shade, how)
    found = [made for how in ways.values() for made in _features(case, how)]
    found += [made for how in ways.values() for made in _maps(case, how)]
    plain = [technique(n) for n in techniques if not technique(n).msaa]
    return found + [_antialiasing(case, how) for how in plain[:1]] + _reference_rays(case)


def _reference_rays(case: Case) -> list[LeftOut]:
    """The reference's shadow rays and further paths, where nothing can occlude."""
    from reference.transport import model_light
    from reference.truths import nothing_occludes, stage

    if not nothing_occludes(case):
        return []
    short = stage(case, "model")
    ways = {"short": short, "full": replace(short, light=model_light)}
    energies = {name: [] for name in ways}
    seconds = {name: [] for name in ways}
    for seed in range(1 + FRAMES):
        for name, way in ways.items():
            start = perf_counter()
            picture = way.trace(REFERENCE_SAMPLES, seed)["global"]
            if seed:  # the first compiles
                seconds[name].append(perf_counter() - start)
                energies[name].append(float(picture[way.traced].mean()))
    mean = np.mean(energies["full"])
    moved = abs(np.mean(energies["short"]) - mean) / mean
    se = np.hypot(*(np.std(e, ddof=1) for e in energies.values())) / mean / FRAMES**0.5
    return [
        LeftOut(
            case=case.id,
            what="reference: shadow rays and further paths",
            why="one flat or convex object: nothing can occlude",
            exact=False,
            difference=moved,
            interval=quantile(0.95, 2 * FRAMES - 2) * se,
            **_saved(np.subtract(seconds["full"], seconds["short"])),
        )
    ]


def relmse(frame: np.ndarray, other: np.ndarray) -> float:
    """Mean squared difference of two frames (H, W, 3) over the mean square of the second."""
    other = other.astype(float)
    square = float(((frame - other) ** 2).mean())
    return square / float((other**2).mean()) if square else 0.0  # also where both are black


def _features(case: Case, how: Technique) -> Iterator[LeftOut]:
    """Every feature that some object does without, compiled into all of them."""
    for feature in LOBES:
        without = [o.name for o in case.objects if not feature.needed(o.material)]
        if not without or not _tested(feature, how):
            continue
        difference, more = _compared(case, replace(how, forced=(feature.name,)), how)
        what, why = WORDS[feature.name]
        yield LeftOut(
            case=case.id,
            what=f"{how.name}: {what}",
            why=f"{why} on {_named(without, len(case.objects))}",
            exact=difference <= SAME,
            difference=difference,
            **_saved(more),
        )


def _tested(feature: Feature, how: Technique) -> bool:
    """Whether a technique's shader asks for a feature at all."""
    return re.search(rf"\b{feature.name}\b", source(how.shade)) is not None


def _maps(case: Case, how: Technique) -> Iterator[LeftOut]:
    """Maps of the environment that nothing reads: they would cost time once, none in a frame."""
    read = {m for o in case.objects for m in how.maps(o.material, case.model)}
    unread = {(name,): what for name, what in MAPS.items() if name not in read}
    beside = tuple(n for n in PREFILTERED if n in read)
    if not beside:  # both are made together
        unread = {names: what for names, what in unread.items() if names[0] not in PREFILTERED}
        unread[PREFILTERED] = "prefiltered environment"
    for names, what in unread.items():
        shared = beside if names[0] in PREFILTERED else ()
        yield LeftOut(
            case=case.id,
            what=f"{how.name}: {what}",
            why=("all light is looked up" if how.samples else "no lobe reads it") + "; saved once",
            exact=True,
            difference=0.0,
            **_saved(_seconds_of_maps(case.environment.path, names, shared)),
        )


@cache
def _seconds_of_maps(path: Path, names: tuple[str, ...], beside: tuple[str, ...]) -> list[float]:
    """What maps take beyond others that are made with them, MAKINGS times."""
    _made(path, (*names, *beside))  # compiles
    return [_made(path, (*names, *beside)) - _made(path, beside) for _ in range(MAKINGS)]


def _made(path: Path, names: tuple[str, ...]) -> float:
    """Seconds for maps beyond the radiance map under them."""
    environment = Precomputed(path)
    start = perf_counter()
    environment.need(names)
    context().finish()
    return perf_counter() - start


def _antialiasing(case: Case, how: Technique) -> LeftOut:
    """Coverage samples, which a technique without antialiasing has no target for."""
    difference, more = _compared(case, replace(how, msaa=SAMPLES), how)
    return LeftOut(
        case=case.id,
        what=f"{how.name}: {SAMPLES} coverage samples a pixel",
        why="the technique asks for no antialiasing",
        exact=False,
        difference=difference,
        **_saved(more),
    )


def _compared(case: Case, more: Technique, how: Technique) -> tuple[float, list[float]]:
    """relMSE of two techniques' frames, and the seconds that the first takes more, by pairs."""
    prepared = []
    for each in (more, how):
        environment = precomputed(case.environment.path)
        environment.need({m for o in case.objects for m in each.maps(o.material, case.model)})
        prepared.append(Renderer(each).prepare(case, environment.maps))
    for ready in prepared:
        draw_frame(ready)
    frames = [ready.target.read().copy() for ready in prepared]
    slower = [_seconds(prepared[0]) - _seconds(prepared[1]) for _ in range(FRAMES)]
    for ready in prepared:
        ready.target.release()
    return relmse(*frames), slower


def _saved(more: Sequence[float]) -> dict[str, float]:
    """Fields of LeftOut: the median of what pairs take more, and their quartiles."""
    told = timed(more)
    return {"saved_seconds": told.median, "saved_low": told.low, "saved_high": told.high}


def _seconds(prepared: Prepared) -> float:
    start = perf_counter()
    draw_frame(prepared)
    return perf_counter() - start


def _named(objects: list[str], count: int) -> str:
    return "all objects" if len(objects) == count > 1 else ", ".join(objects)
