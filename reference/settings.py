"""Settings of the path tracing, apart from Mitsuba so that the store can name them without it."""

import math
from typing import Literal

Kind = Literal["model", "physical"]  # of reference: which materials, and so which truths it holds
TRUTHS: dict[Kind, tuple[str, ...]] = {
    "model": ("global", "direct", "unoccluded"),
    "physical": ("physical",),
}  # the first is the picture itself, the others are layers of it
# After 64 bounces off silver (F0 .98) a quarter of the light is left on a path that never gets
# out; outside a closed cavity paths are far shorter. Roulette ends the dim ones.
PATH = {"type": "path", "max_depth": 65, "rr_depth": 8}
# Against `independent`, at equal time, its variance is 2 to 4 times smaller on rough materials
# and 1 to 2.3 times on smooth metal; `ldsampler` and `stratified` come close, never better.
SAMPLER = "multijitter"
SPLIT = 4  # estimates of the unoccluded light a path; more gain less than they cost
LIGHT_PATHS = 0.25  # from the lamps for each path from the eye; more gain less than they cost
PILOT_SAMPLES, PILOT_SEED = 16, 1984  # for the control variate's factor
FEWEST_BATCHES = 8  # of independent seeds, for intervals


def rounded_samples(asked: int) -> int:
    """Samples per pixel that are taken where `asked` are wanted, at least as many.

    Multi-jittered points need a product of two near-equal integers (32 becomes 5 x 7).
    """
    columns = math.isqrt(asked)
    return columns * math.ceil(asked / columns)


def kind_of(truth: str) -> Kind:
    """The kind of reference that holds a truth."""
    return next(kind for kind, names in TRUTHS.items() if truth in names)
