"""The causes between rungs as signed sums of pictures."""

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from reports.ladder.candidate import Candidate
from reports.ladder.rungs import MODEL_STEPS, NAMES, Terms
from scenes.frame import Frame


@dataclass(frozen=True)
class Step:
    """A cause: its error as a signed sum of pictures, and the diffuse lobe's part of that.

    Attributes:
        diffuse: empty where the diffuse lobe has no part in it, None where that is unknown.
        half: of the batches, from which it is taken: 0 or 1.
    """

    name: str
    terms: Terms
    diffuse: Terms | None
    parent: str = ""
    half: int = 0


def places(rungs: Sequence[str]) -> dict[str, tuple[str, str]]:
    """The two rungs between which each cause beyond integration lies."""
    return dict(zip(NAMES[1:], itertools.pairwise(rungs), strict=False))


def steps_of(
    rungs: Sequence[str], candidate: Candidate, truths: dict[str, list[Frame]]
) -> Iterable[Step]:
    """The causes between the rungs that there are, each followed by its own parts."""
    yield Step(NAMES[0], candidate.error(rungs[0]), candidate.diffuse_error(rungs[0]))
    yield from _integration(rungs[0], candidate)
    for place, (name, (below, above)) in enumerate(places(rungs).items(), start=1):
        half = place % 2
        yield _between(name, candidate, below, above, half)
        if above == "physical" and all(m in truths for m in MODEL_STEPS[:-1]):
            ends = itertools.pairwise([below, *MODEL_STEPS[:-1], above])
            for (a, b), part in zip(ends, MODEL_STEPS, strict=True):
                yield _between(part, candidate, a, b, half, name)


def _between(
    name: str, candidate: Candidate, below: str, above: str, half: int, parent: str = ""
) -> Step:
    """What the candidate is wrong by when the truth moves on, less by what it moves itself."""
    diffuse = candidate.diffuse_step(below, above)
    if diffuse is not None:
        diffuse = *diffuse, (1, f"{below}.diffuse"), (-1, f"{above}.diffuse")
    terms = *candidate.step(below, above), (1, below), (-1, above)
    return Step(name, terms, diffuse, parent, half)


def _integration(truth: str, candidate: Candidate) -> Iterable[Step]:
    """Parts of the integration error of the split sum, by its maps."""
    own = candidate.name[truth]
    drawn = candidate.drawn[own]
    if not drawn.refined or drawn.specular is None:
        return
    specular, fine, table = (f"{own}.{n}" for n in ("specular", "irradiance map", "table"))
    if (drawn.whole != drawn.specular).any():
        coarse = (1, own), (-1, fine)
        yield Step("irradiance map", coarse, coarse, NAMES[0])
        rest = (1, fine), (-1, specular), (-1, f"{truth}.diffuse")
        yield Step("kd at n·v", rest, rest, NAMES[0])
    split = (1, specular), (-1, truth), (1, f"{truth}.diffuse")
    if "table" in drawn.refined:  # some models have tables that are the material's own, and fine
        yield Step("table", ((1, own), (-1, table)), (), NAMES[0])
        split = (1, table), (-1, own), *split
    yield Step("prefilter", split, (), NAMES[0])
