"""The rungs of the ladder, the causes between them, and signed sums of pictures."""

from collections.abc import Iterable, Sequence

import numpy as np

RUNGS = ("unoccluded", "direct", "global", "physical")
NAMES = ("integration", "occlusion", "interreflection", "model")
MODEL_STEPS = ("Fresnel", "kd", "masking")  # from `global` to `physical`, in this order
Terms = Sequence[tuple[int | np.ndarray, str]]  # signs (or a weight for each cell) of pictures


def rungs_of(truths: Iterable[str]) -> list[str]:
    """The rungs that some truths make, from the lowest; none where they are under two or a gap."""
    there = set(truths)
    rungs = [r for r in RUNGS if r in there]
    return rungs if len(rungs) > 1 and rungs == list(RUNGS[: len(rungs)]) else []
