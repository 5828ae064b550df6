"""A bench by hand: realistic, and with all that is odd."""

import math
import random

from reports.results import Figured
from reports.speed.points import (
    Bench,
    EqualError,
    Error,
    Growth,
    LeftOut,
    LobeSampling,
    Point,
    Timed,
)

NAN = math.nan
EVIL = "<b onclick=x>&\"'@7"


def figured(value, part=0.03):
    return Figured(value=value, low=value * (1 - part), high=value * (1 + part))


def timed(median, part=0.04):
    return Timed(median=median, low=median * (1 - part), high=median * (1 + 2 * part), frames=9)


def error(name, local, ssim, part=0.03):
    return Error(
        object=name, material=name, roughness=0.4, weight=0.25, energy_error=figured(-local / 5),
        energy_local=figured(local, part), one_minus_ssim=figured(ssim, part),
    )  # fmt: skip


def point(case="bunnies", family="real-time", name="paper", median=0.065, errors=(), **fields):
    base = {
        "environment": "courtyard", "width": 1920, "height": 1080,
        "compilation": 0.02, "precomputation": 0.4, "preparation": 0.05, "memory": 1.2e8,
        "after": {"light": 0.5, "material": median, "weight": median, "geometry": 2 * median},
    }  # fmt: skip
    return Point(
        case=case, family=family, name=name, frame=timed(median), errors=errors, **base | fields
    )


OBJECTS = {"copper": (0.41, 0.16), "silver": (0.62, 0.22), "red plastic": (0.11, 0.05)}


def bunnies():
    """The paper's picture: six techniques, a path tracer and a denoiser."""

    def errors(scale, part=0.03):
        return [error(n, a * scale, b * scale, part) for n, (a, b) in OBJECTS.items()]

    real = [
        point(errors=errors(1), gpu=timed(0.06), held=6.2e7),
        point(name="paper-noaa", median=0.021, errors=errors(1.05)),
        *(
            point(name=f"sampled@{n}", samples=n, median=0.03 + 0.011 * n, precomputation=0.01,
                  errors=errors(0.9 / n**0.25))
            for n in (1, 4, 16, 64)
        ),
    ]  # fmt: skip
    after = {"light": 0.9, "material": 1.2, "weight": 1.1, "geometry": 2.5}
    traced = [
        point(family="path traced", name=f"Mitsuba {n}", samples=n, median=0.05 + 0.26 * n,
              errors=errors(1.1 / n**0.5, 0.08), compilation=1.8, precomputation=0, after=after)
        for n in (1, 2, 4, 8, 16)
    ]  # fmt: skip
    denoised = [
        point(family="denoised", name=f"Mitsuba {n} + OIDN", samples=n, median=0.6 + 0.27 * n,
              errors=errors(0.35 / n**0.25), compilation=2.1, precomputation=0, memory=NAN,
              after=after)
        for n in (1, 4, 16)
    ]  # fmt: skip
    return [*real, *traced, *denoised]


def lonely():
    """One point of an odd name, without an interval, with an error of 0 and one unknown."""
    nothing = Figured(value=NAN, low=NAN, high=NAN)
    alone = error("ball & <cone>", 0, 0).model_copy(
        update={"energy_local": Figured(value=0, low=NAN, high=NAN), "one_minus_ssim": nothing}
    )
    return [
        point("lonely <i>", name=EVIL, median=0.004, errors=[alone], width=256, height=256,
              precomputation=NAN, after={}, memory=NAN)
    ]  # fmt: skip


def crowd():
    """Sixty techniques."""
    rng = random.Random(7)
    return [
        point("crowd", name=f"technique-{i}", median=10 ** rng.uniform(-3, -1), width=512,
              height=512, errors=[error("sphere", *(10 ** rng.uniform(-3, 0) for _ in "ab"))])
        for i in range(60)
    ]  # fmt: skip


def equal(against="path traced", samples=3.2, took=0.8, ratio=12.3, beyond="", **fields):
    base = {"case": "bunnies", "object": "copper", "technique": "paper", "figure": "energy_local"}
    return EqualError(
        against=against, samples=figured(samples, 0.1), seconds=figured(took, 0.1),
        ratio=figured(ratio, 0.1), beyond=beyond, **base | fields,
    )  # fmt: skip


def grown(over="pixels", technique="paper", cost="frame", base=0.0):
    xs = [130e3, 520e3, 2.07e6, 8.3e6]
    return Growth(
        over=over, technique=technique, cost=cost, sizes=xs, base=base,
        values=[1e-7 * x**0.86 * (1e9 if cost == "memory" else 1) for x in xs],
        exponent=Figured(value=0.86, low=0.83, high=0.9),
    )  # fmt: skip


def full_bench(**fields):
    """Three cases with everything that a bench can hold."""
    lobes = [
        LobeSampling(roughness=r, weight=w, cos_theta=c, sampler=s, points=p, light=light,
                     samples=figured(k * (30 + 400 * (1 - w) * r), 0.2) if w != 1 or s != "beckmann"
                     else Figured(value=NAN, low=NAN, high=NAN))
        for r in (0.2, 0.8) for c, light in ((0.2, "furnace"),)
        for s, k in (("ggx", 3), ("mixture", 1), ("beckmann", 8))
        for p in ("Hammersley", "random") for w in (0, 0.25, 0.5, 0.75, 1)
    ]  # fmt: skip
    base = {
        "suite": "bench", "suite_path": "bench.toml", "command": "shadeproof bench <all>",
        "created": "2026-01-01T00:00:00Z", "seconds": 612,
        "provenance": {
            "device": "llvmpipe (LLVM 15.0.6, 256 bits)", "machine": "x86_64, Linux 6.1",
            "versions": {"mitsuba": "3.9.1", "moderngl": "5.13"},
        },
        "points": [*bunnies(), *lonely(), *crowd()],
        "equal": [
            equal(), equal("denoised", 1, 0.87, 13.4, "below"),
            equal(technique="paper-noaa", ratio=0.62, took=0.013, samples=1),
            equal("denoised", NAN, NAN, NAN, "above", technique="sampled@64"),
        ],
        "growths": [
            *(grown(technique=t) for t in ("paper", "paper-noaa", "sampled@16")),
            grown("environment", cost="precomputation", base=0.003), grown(cost="memory"),
        ],
        "left_out": [
            LeftOut(case="bunnies", what="Beckmann lobe", why="its weight is 0", exact=True,
                    difference=3.1e-9, saved_seconds=0.0042),
            LeftOut(case="bunnies", what="path depth beyond 6", why="adds less than its interval",
                    exact=False, difference=0.0004, interval=0.002),
        ],
        "lobes": lobes, "skipped": ["denoised: mitsuba-oidn is not installed"],
    }  # fmt: skip
    return Bench(**base | fields)


def small_bench(**fields):
    """Points alone."""
    return full_bench(
        **{"equal": [], "growths": [], "left_out": [], "lobes": [], "skipped": []} | fields
    )
