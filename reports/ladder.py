"""Error by cause: how far each thing that a real-time renderer leaves out takes it from the truth.

The truths T1 to T4 are a ladder: without visibility, with shadows, with full transport, with
physical materials. R1 to R4 are the candidate with what each truth has switched on, the same
picture where it has no such switch, and E_k = R_k - T_k. Then integration = E1,
occlusion = E2 - E1, interreflection = E3 - E2 and model = E4 - E3 sum to the total error E4. Each
is a signed sum of pictures, so integration and model can be split further wherever there is a
picture in between.

Each reference's batches are halved. Steps that follow each other come from different halves, and
the total from another than the last, so that no rung cancels and batches that do not agree keep the
sum from closing. (A rung that is wrong alike in all its batches is not seen: it moves error from
one cause to the next.)
"""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
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


def rungs_of(truths: Iterable[str]) -> list[str]:
    """The rungs that some truths make, from the lowest; none where they are under two or a gap."""
    there = set(truths)
    rungs = [r for r in RUNGS if r in there]
    return rungs if len(rungs) > 1 and rungs == list(RUNGS[: len(rungs)]) else []


def ladder(
    case: Case,
    obj: Object,
    technique: str,
    drawn: Mapping[str, Drawn],
    truths: dict[str, list[Frame]],
    rows: Iterable[Row],
) -> Ladder | None:
    """The causes of one object's error; None where there are too few rungs or batches for it.

    Args:
        drawn: what stands against each of the truths; the same object where no switch parts them.
        truths: batches by truth, each with the layer `diffuse`; under the names in MODEL_STEPS
            those of the models in between `global` and `physical`.
        rows: the object's rows, one a truth, for the steps of SSIM.
    """
    rungs = rungs_of(truths)
    if not rungs:
        return None
    ids = truths[rungs[0]][0].ids
    mask = ids == case.index(obj.name)
    candidate = Candidate(drawn)
    if not candidate.fits(ids) or not mask.any() or min(map(len, truths.values())) < FEWEST:
        return None
    last, whole = rungs[-1], candidate.error(rungs[-1])
    steps = [*_steps(rungs, candidate, truths)]
    pixels = _pictures(candidate, truths, lambda rgb: rgb[mask].mean(axis=1, dtype=np.float64))
    blocks = _pictures(candidate, truths, lambda rgb: block_sums(rgb, mask))
    covered = block_sums(mask[..., None], mask)
    other = 1 - steps[-1].half
    energy, local = Energy(pixels, last), Local(blocks, covered, whole, other)
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
        switched=[n for n, (a, b) in _places(rungs).items() if candidate.switched(a, b)],
        causes=causes,
        total=Cause(
            name="total",
            energy=_figured(energy.of(whole, other)),
            diffuse=_diffuse(energy, candidate.diffuse_error(last), other),
            local=_figured(local.total),
            ssim=_figured(_less(ssim.get(last), Estimate(1.0))),
        ),
        energy_gap=_figured(gaps[0]),
        local_gap=_figured(gaps[1]),
        closes=all(low <= 0 <= high for low, high in (g.interval(CLOSURE) for g in gaps)),
        missing=_missing(blocks, covered, candidate) if "global" in rungs else {},
    )


class Candidate:
    """A candidate on its way up the ladder: its pictures by name, and sums of them.

    Args:
        drawn: what stands against each truth; the same object where no switch parts them.
    """

    def __init__(self, drawn: Mapping[str, Drawn]) -> None:
        first: dict[int, str] = {}
        self.name = {truth: first.setdefault(id(d), f"R {truth}") for truth, d in drawn.items()}
        self.drawn = {self.name[truth]: d for truth, d in drawn.items()}

    def fits(self, ids: np.ndarray) -> bool:
        """Whether every picture is of the size of `ids`, (H, W), and finite."""
        wholes = [d.whole for d in self.drawn.values()]
        return all(w.shape[:2] == ids.shape and np.isfinite(w).all() for w in wholes)

    def switched(self, below: str, above: str) -> bool:
        """Whether a switch parts what stands against two truths."""
        return self.name[below] != self.name[above]

    def error(self, truth: str) -> Terms:
        """What it is wrong by against a truth."""
        return (1, self.name[truth]), (-1, truth)

    def diffuse_error(self, truth: str) -> Terms | None:
        """The same of its own diffuse light; None where that is unknown."""
        own = self._diffuse(truth)
        return None if own is None else (*own, (-1, f"{truth}.diffuse"))

    def step(self, below: str, above: str) -> Terms:
        """What it moves by from one truth to the next; nothing where no switch parts them."""
        if not self.switched(below, above):
            return ()
        return (1, self.name[above]), (-1, self.name[below])

    def diffuse_step(self, below: str, above: str) -> Terms | None:
        """The same of its diffuse light; None where that is unknown."""
        if not self.switched(below, above):
            return ()
        ends = self._diffuse(above), self._diffuse(below)
        if ends[0] is None or ends[1] is None:
            return None
        return (*ends[0], *((-sign, name) for sign, name in ends[1]))

    def pictures(self) -> dict[str, np.ndarray]:
        """All of them, (H, W, 3): whole, without the diffuse lobe, with a map made finely."""
        found = {name: d.whole for name, d in self.drawn.items()}
        for name, d in self.drawn.items():
            if d.specular is not None:
                found[f"{name}.specular"] = d.specular
            found |= {f"{name}.{fine}": rgb for fine, rgb in d.refined.items()}
        return found

    def _diffuse(self, truth: str) -> Terms | None:
        name = self.name[truth]
        return None if self.drawn[name].specular is None else ((1, name), (-1, f"{name}.specular"))


def _places(rungs: Sequence[str]) -> dict[str, tuple[str, str]]:
    """The two rungs between which each cause beyond integration lies."""
    return dict(zip(NAMES[1:], itertools.pairwise(rungs), strict=False))


def _steps(
    rungs: Sequence[str], candidate: Candidate, truths: dict[str, list[Frame]]
) -> Iterable[Step]:
    """The causes between the rungs that there are, each followed by its own parts."""
    yield Step(NAMES[0], candidate.error(rungs[0]), candidate.diffuse_error(rungs[0]))
    yield from _integration(rungs[0], candidate)
    for place, (name, (below, above)) in enumerate(_places(rungs).items(), start=1):
        half = place % 2
        yield _between(name, candidate, below, above, half)
        if above == "physical" and all(m in truths for m in MODEL_STEPS[:-1]):
            places = itertools.pairwise([below, *MODEL_STEPS[:-1], above])
            for (a, b), part in zip(places, MODEL_STEPS, strict=True):
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


def _pictures(candidate: Candidate, truths: dict[str, list[Frame]], cells) -> Pictures:
    """Everything that steps are made of, as light in cells."""
    made = {name: cells(rgb)[None] for name, rgb in candidate.pictures().items()}
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

    def __init__(self, blocks: Pictures, pixels: np.ndarray, whole: Terms, other: int) -> None:
        self.blocks, self.whole, self.other = blocks, whole, other
        own, last = (name for _, name in whole)
        self.dof = blocks.least() // 2 - 1
        self.error, self.noise = zip(*(blocks.total(self.whole, h) for h in (0, 1)), strict=True)
        candidate, batches = (blocks.cells[n].reshape(-1, pixels.size // 3, 3) for n in (own, last))
        channel = worst_channel(pixels[::3], candidate[0], batches)
        weights = block_weights(pixels[::3], batches.mean(axis=0))
        self.weights = np.where(np.arange(3) == channel, weights, 0).ravel()
        errors = blocks.cells[own] - blocks.cells[last][other::2]
        products = self.weights * errors[:, None] * errors
        cells = pairs(products)
        self.square = float(cells.sum())
        self.root = math.sqrt(self.square) if self.square > 0 else math.nan
        # Where noise hides local energy there are no shares, but the sum can still be held to it.
        self.scale = self.root if self.square > 0 else math.sqrt(float(np.abs(cells).sum())) or 1.0
        variance = (
            jackknife(pairs_without_each(products))
            if len(errors) > 2
            else np.full(cells.shape, np.nan)
        )
        se, dof = combined(variance, len(errors) - 1)
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


def _missing(blocks: Pictures, pixels: np.ndarray, candidate: Candidate) -> dict[str, Figured]:
    """How much of the occlusion and of the interreflection the candidate lacks, as fractions.

    By least squares over the blocks, each over the block's light. A candidate with a switch for one
    of them draws R2 - R1 of T2 - T1 and R3 - R2 of T3 - T2, a slope each. Else R1 - T1 is fitted by
    T2 - T1, T3 - T2 and T1 (a gain, so that a picture too bright is not taken for one without
    shadows). Products are taken between different batches, so that noise does not flatten the
    slopes.

    What else is wrong with a candidate may look alike, and a share need not be the same everywhere.
    So the error holds what batches move the slopes by, what parts of the object do, and what other
    weights of the blocks do.
    """
    one, two, three = (blocks.cells[t] for t in RUNGS[:3])
    drawn = [np.broadcast_to(blocks.cells[candidate.name[t]], one.shape) for t in RUNGS[:3]]
    if candidate.switched(*RUNGS[:2]) or candidate.switched(*RUNGS[1:3]):
        fits = [
            np.stack([truth, own], axis=1)
            for truth, own in ((two - one, drawn[1] - drawn[0]), (three - two, drawn[2] - drawn[1]))
        ]
    else:
        fits = [np.stack([two - one, three - two, one, drawn[0] - one], axis=1)]
    lit = (three.mean(axis=0) > 0) & (one.mean(axis=0) > 0)
    pixels, first, light = pixels[lit], one[:, lit].mean(axis=0), three[:, lit].mean(axis=0)
    weights = [np.sqrt(pixels) / light, np.sqrt(pixels) / first]
    weights += [1 / np.sqrt(light), 1 / np.sqrt(pixels)]
    slopes = [slope for vectors in fits for slope in _slopes(vectors[..., lit], weights)]
    return {
        name: _figured(Estimate(1 - slope.value, slope.se, slope.dof))
        for name, slope in zip(NAMES[1:3], slopes, strict=False)
    }


def _slopes(vectors: np.ndarray, weights: Sequence[np.ndarray]) -> list[Estimate]:
    """The slopes of a fit by the first of some weights of the cells, with all that moves them."""
    batches, cells = np.arange(len(vectors)), np.arange(vectors.shape[2])
    fit = _Fit(vectors, weights[0])
    by_batch = np.stack([fit(batches[batches != k], cells) for k in batches])
    parts = np.array_split(cells, PARTS)
    by_part = np.stack([fit(batches, np.setdiff1d(cells, part)) for part in parts])
    others = [_Fit(vectors, w)(batches, cells) for w in weights]
    error = np.sqrt(jackknife(by_batch) + jackknife(by_part) + np.var(others, axis=0, ddof=1))
    dof = len(weights) - 1
    return [
        Estimate(float(value), float(se), dof)
        for value, se in zip(fit(batches, cells), error, strict=True)
    ]


@dataclass(frozen=True)
class _Fit:
    """The slopes of the last of some pictures on the others, from some batches and cells.

    Attributes:
        vectors: (n, m + 1, c), pictures as light in cells, of n batches.
        weights: (c,) by which cells are scaled.
    """

    vectors: np.ndarray
    weights: np.ndarray

    def __call__(self, batches: np.ndarray, cells: np.ndarray) -> np.ndarray:
        """(m,), NaN where the others do not tell."""
        known = self.vectors.shape[1] - 1
        kept = self.vectors[np.ix_(batches, range(known + 1), cells)] * self.weights[cells]
        total = kept.sum(axis=0)
        products = total @ total.T - np.einsum("kac,kbc->ab", kept, kept)
        try:
            return np.linalg.solve(products[:known, :known], products[:known, known])
        except np.linalg.LinAlgError:
            return np.full(known, np.nan)


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
