"""Error by cause: how far each thing that a real-time renderer leaves out takes it from the truth.

The truths T1 to T4 are a ladder: without visibility, with shadows, with full transport, with
physical materials. R is the candidate and E = R - T. Then integration = E1, occlusion = E2 - E1,
interreflection = E3 - E2 and model = E4 - E3 sum to the total error E4. Each is a signed sum of
pictures, so integration and model can be split further wherever there is a picture in between.

Each reference's batches are halved. Steps that follow each other come from different halves, and
the total from another than the last, so that no rung cancels and batches that do not agree keep the
sum from closing. (A rung that is wrong alike in all its batches is not seen: it moves error from
one cause to the next.)
"""

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from reports.metrics.energy import block_sums, block_weights, worst_channel
from reports.noise import Estimate, combined, jackknife, pairs, pairs_without_each
from reports.results import Cause, Figured, Ladder, Row
from scenes.frame import Frame
from scenes.schema import Case, Object

RUNGS = ("unoccluded", "direct", "global", "physical")
NAMES = ("integration", "occlusion", "interreflection", "model")
MODEL_STEPS = ("Fresnel", "kd", "masking")  # from `global` to `physical`, in this order
PARTS = 16  # of an object, by rows of blocks, for the spread of what a candidate lacks
FEWEST = 4  # batches of each reference: two in each half
CLOSURE = 0.9999  # confidence of a gap, so that the hundred gaps of a suite close but by 1 %
Terms = Sequence[tuple[int | np.ndarray, str]]  # signs (or a weight for each cell) of pictures


@dataclass(frozen=True)
class Drawn:
    """A candidate's picture of a case, and the same with single switches thrown.

    Attributes:
        whole: linear radiance, (H, W, 3).
        specular: the same without the light of the diffuse lobe; None where it cannot be had.
        refined: the same with one precomputed map free of its own error, by the map's name.
    """

    whole: np.ndarray
    specular: np.ndarray | None = None
    refined: dict[str, np.ndarray] = field(default_factory=dict)


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


@dataclass(frozen=True)
class Pictures:
    """Pictures of an object as light in cells, by name.

    Attributes:
        cells: (n, c): n batches of a truth, or 1 for a candidate; c cells.
        source: the reference that a picture's batches belong to, so that what shares its paths is
            subtracted path by path; empty for a candidate, which has no noise here.
    """

    cells: dict[str, np.ndarray]
    source: dict[str, str]

    def total(self, terms: Terms, half: int | None = None) -> tuple[np.ndarray, np.ndarray]:
        """A signed sum of pictures, (c,), and its variance.

        Args:
            half: 0 or 1 for the even or the odd batches, None for all.
        """
        chosen = slice(half, None, None if half is None else 2)
        value = variance = np.zeros(next(iter(self.cells.values())).shape[1])
        for source in dict.fromkeys(self.source[name] for _, name in terms):
            own = [(sign, name) for sign, name in terms if self.source[name] == source]
            if not source:
                value = value + sum(sign * self.cells[name][0] for sign, name in own)
                continue
            batches = sum(sign * self.cells[name][chosen] for sign, name in own)
            value = value + batches.mean(axis=0)
            variance = variance + batches.var(axis=0, ddof=1) / len(batches)
        return value, variance

    def least(self) -> int:
        """The fewest batches of any truth."""
        return min(len(c) for n, c in self.cells.items() if self.source[n])


def ladder(
    case: Case,
    obj: Object,
    technique: str,
    drawn: Drawn,
    truths: dict[str, list[Frame]],
    rows: Iterable[Row],
) -> Ladder | None:
    """The causes of one object's error; None where there are too few rungs or batches for it.

    Args:
        truths: batches by truth, each with the layer `diffuse`; under the names in MODEL_STEPS
            those of the models in between `global` and `physical`.
        rows: the object's rows, one a truth, for the steps of SSIM.
    """
    rungs = [r for r in RUNGS if r in truths]
    if rungs != list(RUNGS[: len(rungs)]) or len(rungs) < 2:
        return None
    ids = truths[rungs[0]][0].ids
    mask = ids == case.index(obj.name)
    wrong = not np.isfinite(drawn.whole).all() or drawn.whole.shape[:2] != ids.shape
    if wrong or not mask.any() or min(len(b) for b in truths.values()) < FEWEST:
        return None
    last, whole = rungs[-1], ((1, "candidate"), (-1, rungs[-1]))
    steps = [*_steps(rungs, drawn, truths)]
    pixels = _pictures(drawn, truths, lambda rgb: rgb[mask].mean(axis=1, dtype=np.float64))
    blocks = _pictures(drawn, truths, lambda rgb: block_sums(rgb, mask))
    covered = block_sums(mask[..., None], mask)
    other = 1 - steps[-1].half
    energy, local = Energy(pixels, last), Local(blocks, covered, last, other)
    ssim = {r.truth: Estimate(r.ssim, r.ssim_se, r.ssim_dof) for r in rows}
    causes = [
        Cause(
            name=step.name,
            parent=step.parent,
            energy=_figured(energy.of(step.terms, step.half)),
            diffuse=_diffuse(energy, step.diffuse, step.half),
            local=_figured(local.share(step.terms, step.half)),
            ssim=_ssim_step(step.name, rungs, ssim),
        )
        for step in steps
    ]
    top = [
        [t for s in steps if s.half == half and not s.parent for t in s.terms] for half in (0, 1)
    ]
    gaps = energy.gap(top, whole, other), local.gap(top)
    return Ladder(
        case=case.id,
        object=obj.name,
        technique=technique,
        truth=last,
        causes=causes,
        total=Cause(
            name="total",
            energy=_figured(energy.of(whole, other)),
            diffuse=_diffuse(energy, _own_diffuse(drawn, last), other),
            local=_figured(local.total),
            ssim=_figured(_less(ssim.get(last), Estimate(1.0))),
        ),
        energy_gap=_figured(gaps[0]),
        local_gap=_figured(gaps[1]),
        closes=all(low <= 0 <= high for low, high in (g.interval(CLOSURE) for g in gaps)),
        missing=_missing(blocks, covered) if "global" in rungs else {},
    )


def _steps(rungs: Sequence[str], drawn: Drawn, truths: dict[str, list[Frame]]) -> Iterable[Step]:
    """The causes between the rungs that there are, each followed by its own parts."""
    yield Step(NAMES[0], ((1, "candidate"), (-1, rungs[0])), _own_diffuse(drawn, rungs[0]))
    if drawn.refined and drawn.specular is not None:
        yield from _integration(rungs[0], drawn)
    for place, (below, above) in enumerate(itertools.pairwise(rungs), start=1):
        name, half = NAMES[place], place % 2
        yield _between(name, below, above, half)
        if above == "physical" and all(m in truths for m in MODEL_STEPS[:-1]):
            places = itertools.pairwise([below, *MODEL_STEPS[:-1], above])
            for (a, b), part in zip(places, MODEL_STEPS, strict=True):
                yield _between(part, a, b, half, name)


def _own_diffuse(drawn: Drawn, truth: str) -> Terms | None:
    """The error of the candidate's own diffuse light; None where it is unknown."""
    if drawn.specular is None:
        return None
    return (1, "candidate"), (-1, "specular"), (-1, f"{truth}.diffuse")


def _between(name: str, below: str, above: str, half: int, parent: str = "") -> Step:
    """What the candidate is wrong by, since it stays where it is, when the truth moves on."""
    diffuse = (1, f"{below}.diffuse"), (-1, f"{above}.diffuse")
    return Step(name, ((1, below), (-1, above)), diffuse, parent, half)


def _integration(truth: str, drawn: Drawn) -> Iterable[Step]:
    """Parts of the integration error of the split sum, by its maps."""
    if (drawn.whole != drawn.specular).any():
        fine = "irradiance map"
        own = (1, "candidate"), (-1, fine)
        yield Step(fine, own, own, NAMES[0])
        rest = (1, fine), (-1, "specular"), (-1, f"{truth}.diffuse")
        yield Step("kd at n·v", rest, rest, NAMES[0])
    split = (1, "specular"), (-1, truth), (1, f"{truth}.diffuse")
    if "table" in drawn.refined:  # some models have tables that are the material's own, and fine
        yield Step("table", ((1, "candidate"), (-1, "table")), (), NAMES[0])
        split = (1, "table"), (-1, "candidate"), *split
    yield Step("prefilter", split, (), NAMES[0])


def _pictures(drawn: Drawn, truths: dict[str, list[Frame]], cells) -> Pictures:
    """Everything that steps are made of, as light in cells."""
    own = {"candidate": drawn.whole, **drawn.refined}
    if drawn.specular is not None:
        own["specular"] = drawn.specular
    made = {name: cells(rgb)[None] for name, rgb in own.items()}
    source = dict.fromkeys(made, "")
    for name, batches in truths.items():
        # The three truths of one model share their paths.
        shared = "model" if name in RUNGS[:3] else name
        made[name] = np.stack([cells(b.rgb) for b in batches])
        made[f"{name}.diffuse"] = np.stack([cells(b.layers["diffuse"]) for b in batches])
        source |= {name: shared, f"{name}.diffuse": shared}
    return Pictures(made, source)


class Energy:
    """Errors of the light on the whole object, over the last truth's; cells are pixels."""

    def __init__(self, pictures: Pictures, last: str) -> None:
        self.pictures = pictures
        self.dof = pictures.least() // 2 - 1
        light, variance = pictures.total([(1, last)])
        self.light = float(light.sum())
        self.relative = float(np.sqrt(variance.sum()) / self.light) if self.light > 0 else math.nan

    def of(self, terms: Terms, half: int) -> Estimate:
        """A signed sum of pictures, as a fraction of the truth's light."""
        if not self.light > 0:
            return Estimate(math.nan, math.nan)
        cells, variance = self.pictures.total(terms, half)
        value, (se, dof) = float(cells.sum()) / self.light, combined(variance, self.dof)
        return Estimate(value, se / self.light, dof).plus(value * self.relative)

    def gap(self, steps: Sequence[Terms], total: Terms, other: int) -> Estimate:
        """What the steps of both halves, summed, are off from the total of the half `other`."""
        sides = [[*own] for own in steps]
        sides[other] += [(-sign, name) for sign, name in total]
        cells, variances = zip(
            *(self.pictures.total(s, half) for half, s in enumerate(sides)), strict=True
        )
        se, dof = combined(np.concatenate(variances), self.dof)
        return Estimate(float(np.sum(cells)) / self.light, se / self.light, dof)


class Local:
    """Errors in blocks, as signed shares of local energy; cells are blocks of one channel.

    With e the total error of a block over its truth, local energy is the root L of the weighted
    mean of e², in the same channel and by the same weights as the row's `energy_local`, but of a
    half of the batches. A cause with error s in the blocks has the share mean(s e) / L: shares are
    signed, and those of causes that sum to e sum to L. s and e come from different batches.
    """

    def __init__(self, blocks: Pictures, pixels: np.ndarray, last: str, other: int) -> None:
        self.blocks, self.whole, self.other = blocks, ((1, "candidate"), (-1, last)), other
        self.dof = blocks.least() // 2 - 1
        self.error, self.noise = zip(*(blocks.total(self.whole, h) for h in (0, 1)), strict=True)
        candidate, batches = (
            blocks.cells[n].reshape(-1, pixels.size // 3, 3) for n in ("candidate", last)
        )
        channel = worst_channel(pixels[::3], candidate[0], batches)
        weights = block_weights(pixels[::3], batches.mean(axis=0))
        self.weights = np.where(np.arange(3) == channel, weights, 0).ravel()
        own = blocks.cells["candidate"] - blocks.cells[last][other::2]
        products = self.weights * own[:, None] * own
        cells = pairs(products)
        self.square = float(cells.sum())
        self.root = math.sqrt(self.square) if self.square > 0 else math.nan
        # Where noise hides local energy there are no shares, but the sum can still be held to it.
        self.scale = self.root if self.square > 0 else math.sqrt(float(np.abs(cells).sum())) or 1.0
        variance = (
            jackknife(pairs_without_each(products))
            if len(own) > 2
            else np.full(cells.shape, np.nan)
        )
        se, dof = combined(variance, len(own) - 1)
        self.total = Estimate(self.root, se / (2 * self.root), dof)

    def share(self, terms: Terms, half: int) -> Estimate:
        """A cause's signed share."""
        (own, noise), error = self.blocks.total(terms, half), self.error[1 - half]
        value = float(np.sum(self.weights * own * error)) / self.root
        variance = self.weights**2 * (own**2 * self.noise[1 - half] + error**2 * noise)
        se, dof = combined(variance, self.dof)
        return Estimate(value, se / self.root, dof).plus(value * self.total.se / self.root)

    def gap(self, steps: Sequence[Terms]) -> Estimate:
        """What the shares of both halves' steps, summed, are off from the total.

        The gap is sum(s0 e1 + s1 e0) - sum(e²), so the noise of a half's batches enters as they
        are weighted in its derivative.
        """
        own = [self.blocks.total(terms, half)[0] for half, terms in enumerate(steps)]
        value, variances = -self.square, []
        for half, terms in enumerate(steps):
            error = self.error[1 - half]
            value += float(np.sum(self.weights * own[half] * error))
            slope = own[1 - half] - (2 * self.error[half] if half == self.other else 0)
            moved = [(sign * error, n) for sign, n in terms]
            moved += [(sign * slope, n) for sign, n in self.whole]
            variances.append(self.weights**2 * self.blocks.total(moved, half)[1])
        se, dof = combined(np.concatenate(variances), self.dof)
        return Estimate(value / self.scale, se / self.scale, dof)


def _missing(blocks: Pictures, pixels: np.ndarray) -> dict[str, Figured]:
    """How much of the occlusion and of the interreflection the candidate lacks, as fractions.

    Least squares of R - T1 on T2 - T1, T3 - T2 and T1 (a gain, so that a picture too bright is not
    taken for one without shadows) over the blocks, each over the block's light. Products are
    taken between different batches, so that noise does not flatten the slopes.

    What else is wrong with the candidate may look alike. So its error holds what batches move the
    slopes by, what parts of the object do, and what other weights of the blocks do.
    """
    one, two, three = (blocks.cells[t] for t in RUNGS[:3])
    vectors = np.stack([two - one, three - two, one, blocks.cells["candidate"] - one], axis=1)
    lit = (three.mean(axis=0) > 0) & (one.mean(axis=0) > 0)
    vectors, pixels, first, light = vectors[..., lit], pixels[lit], one[:, lit], three[:, lit]
    weights = [np.sqrt(pixels) / light.mean(axis=0), np.sqrt(pixels) / first.mean(axis=0)]
    weights += [1 / np.sqrt(light.mean(axis=0)), 1 / np.sqrt(pixels)]
    batches, cells = np.arange(len(vectors)), np.arange(len(pixels))
    fit = _Fit(vectors, weights[0])
    by_batch = np.stack([fit(batches[batches != k], cells) for k in batches])
    parts = np.array_split(cells, PARTS)
    by_part = np.stack([fit(batches, np.setdiff1d(cells, part)) for part in parts])
    others = [_Fit(vectors, w)(batches, cells) for w in weights]
    error = np.sqrt(jackknife(by_batch) + jackknife(by_part) + np.var(others, axis=0, ddof=1))
    return {
        name: _figured(Estimate(float(value), float(se), len(weights) - 1))
        for name, value, se in zip(NAMES[1:3], 1 - fit(batches, cells), error, strict=True)
    }


@dataclass(frozen=True)
class _Fit:
    """Slopes of occlusion and interreflection, from some batches and cells.

    Attributes:
        vectors: (n, 4, c): T2 - T1, T3 - T2, T1 and R - T1.
        weights: (c,) by which cells are scaled.
    """

    vectors: np.ndarray
    weights: np.ndarray

    def __call__(self, batches: np.ndarray, cells: np.ndarray) -> np.ndarray:
        kept = self.vectors[np.ix_(batches, range(4), cells)] * self.weights[cells]
        total = kept.sum(axis=0)
        products = total @ total.T - np.einsum("kac,kbc->ab", kept, kept)
        try:
            return np.linalg.solve(products[:3, :3], products[:3, 3])[:2]
        except np.linalg.LinAlgError:
            return np.full(2, np.nan)


def _ssim_step(name: str, rungs: Sequence[str], ssim: dict[str, Estimate]) -> Figured | None:
    """How much SSIM moves from one rung to the next; only whole causes have such a step."""
    if name not in NAMES:
        return None
    place = NAMES.index(name)
    before = ssim.get(rungs[place - 1]) if place else Estimate(1.0)
    return _figured(_less(ssim.get(rungs[place]), before))


def _diffuse(energy: Energy, terms: Terms | None, half: int) -> Figured | None:
    return None if terms is None else _figured(energy.of(terms, half))


def _less(a: Estimate | None, b: Estimate | None) -> Estimate:
    """a - b of independent estimates."""
    if a is None or b is None:
        return Estimate(math.nan, math.nan)
    known = [e.dof for e in (a, b) if e.se > 0]
    return Estimate(a.value - b.value, math.hypot(a.se, b.se), min(known, default=0.0))


def _figured(estimate: Estimate) -> Figured:
    low, high = estimate.interval()
    return Figured(value=estimate.value, low=low, high=high)
