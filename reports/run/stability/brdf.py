"""The whole BRDF over widths, angles and weights: one sweep of evaluations, a map an invariant."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from reports.run.stability.sides import exact, mitsuba, shader, stock
from reports.stability.agreement import TOLERANCE
from reports.stability.functions import Inputs
from reports.stability.grid import (
    ALPHA,
    ALPHAS,
    COSINE,
    COSINES,
    JUDGED,
    PER_CELL,
    WEIGHT,
    WEIGHTS,
    axis,
    pairs,
)
from reports.stability.maps import SCALE, Shown, difference, make_map
from reports.stability.oracle import half_vector
from reports.stability.results import Map

CELLS = (len(COSINES), len(ALPHAS))
RECIPROCAL = 1e-6  # the same sums in another order
STOCK_BECKMANN = 7.1e-3  # Mitsuba's G1 of Beckmann is a rational fit, .35 % off, and G has two
# Of nearly opposite directions the stock plugin's dot products cancel: at wi.h = .01 its density is
# off by 3e-4, and at 1e-4 it takes the facets for ones that face away.
STOCK_KNOWN = 0.05
STEP = 1e-3  # of alpha, relative
ROUNDING = 1e-5  # of the largest value, beside a step
# Half copper over a coloured plastic, so that every term and channel counts.
SURFACE = {"albedo": (0.3, 0.15, 0.025), "f0": (0.5, 0.33, 0.29)}
WHITE_METAL = {"albedo": (0.0, 0.0, 0.0), "f0": (1.0, 1.0, 1.0)}


class Sweep:
    """The BRDF of one masking on the directions of every cell of weight x n.v x alpha."""

    def __init__(self, masking: str, weights: np.ndarray = WEIGHTS) -> None:
        self.masking, self.weights = masking, weights
        self.alpha, self.wi, self.wo = pairs()

    def inputs(self, weight: float) -> Inputs:
        """The inputs of all rows for one GGX share."""
        shares = np.float32([weight, 1 - weight])
        directions = {"alpha": self.alpha, "wi": self.wi, "wo": self.wo}
        return SURFACE | directions | {"weight": shares, "weight_g": shares}

    def shown(self, at: tuple[int, ...], **changed: Any) -> Shown:
        """The inputs behind one figure, as a command takes them."""
        row = np.ravel_multi_index(at[1:], (*CELLS, PER_CELL))
        directions = {"wi": self.wi[row], "wo": self.wo[row], "alpha": self.alpha[row]}
        shares = {"weight": self.weights[at[0]], "masking": self.masking}
        return directions | shares | SURFACE | changed

    def map(self, invariant: str, figures: np.ndarray, **said: Any) -> Map:
        """A map over weight, n.v and alpha of figures (weights, n)."""
        return make_map(
            "brdf",
            invariant,
            figures.reshape(len(self.weights), *CELLS, PER_CELL),
            (WEIGHT, COSINE, ALPHA),
            said.pop("reproduce", lambda at: [self.shown(at)]),
            masking=self.masking,
            **said,
        )

    def maps(self) -> Iterator[Map]:
        """Every invariant of this masking."""
        slices = [self.inputs(w) for w in self.weights]
        forth = np.stack([shader("brdf", i, self.masking) for i in slices])
        truth = np.stack([exact("brdf", i, self.masking) for i in slices])
        yield self.agreement("against float64", forth, truth)
        reference = np.stack([mitsuba(i, self.masking) for i in slices])
        yield self.agreement("against Mitsuba", forth, reference)
        yield self.map(
            "finite",
            (~np.isfinite(forth)).sum(axis=-1).astype(float),
            why="One NaN or Inf blackens a pixel, and every pixel that a filter mixes it into.",
            unit="channels that are NaN or Inf",
            limit=0.0,
        )
        yield self.map(
            "non-negative",
            np.maximum(-np.nan_to_num(forth), 0).max(axis=-1),
            why="A share of light that is sent back is never negative.",
            unit="how far f is below 0 (sr^-1)",
            limit=0.0,
        )
        back = [shader("brdf", i | {"wi": i["wo"], "wo": i["wi"]}, self.masking) for i in slices]
        yield self.map(
            "reciprocal",
            np.stack([difference(b, f, CELLS) for b, f in zip(back, forth, strict=True)]),
            why="f(wi, wo) = f(wo, wi) (Helmholtz): D is of h, and both maskings are symmetric.",
            unit=SCALE,
            limit=RECIPROCAL,
            reproduce=lambda at: [self.shown(at), _swapped(self.shown(at))],
        )
        yield self.smooth_in_weight(forth)
        yield self.smooth_in_roughness(slices, forth, truth)

    def agreement(self, invariant: str, ours: np.ndarray, theirs: np.ndarray) -> Map:
        """Two evaluations of the same model."""
        return self.map(
            invariant,
            np.stack([difference(o, t, CELLS) for o, t in zip(ours, theirs, strict=True)]),
            why="One model from the same float32 directions: what is left is rounding, which a "
            "narrow lobe magnifies by the slope of its logarithm.",
            unit=SCALE,
            limit=TOLERANCE,
            judged=JUDGED,
        )

    def smooth_in_weight(self, forth: np.ndarray) -> Map:
        """Steps between neighbouring weights, over 4 times the step in weight.

        D and G are means by weight, so df/dw is at most twice the largest f of a pair of lobes, or
        with Smith's harmonic mean of G1, where Lambda's ratio is below 1.8, under 4 times.
        """
        largest = largest_end(self.inputs(0), self.masking)
        steps = [
            weight_step(before, after, step, largest).max(axis=-1)
            for (before, after), step in zip(pairwise(forth), np.diff(self.weights), strict=True)
        ]
        return self.map(
            "smooth in weight",
            np.stack([*steps, steps[-1]]),  # the last weight has no neighbour above
            why="D and G are means by weight: a step in weight moves f by at most 4 times as much "
            "of the lobes' largest, also where a lobe is compiled in or out.",
            unit="step of f to the next weight, over the largest that the model allows",
            limit=1.0,
            reproduce=lambda at: [
                self.shown(at, weight=self.weights[k])
                for k in (min(at[0], len(self.weights) - 2) + np.arange(2))
            ],
        )

    def smooth_in_roughness(self, slices, forth: np.ndarray, truth: np.ndarray) -> Map:
        """Steps where alpha grows by a thousandth, over 4 times that of the lobe's peak.

        |d ln D / d ln alpha| is at most 2 for GGX; for Beckmann |2 t - 2| exp(-t) is at most 2 as a
        share of the peak, and G1's slopes stay below 1.
        """
        wider = (self.alpha * np.float32(1 + STEP)).astype(np.float32)
        after = np.stack([shader("brdf", i | {"alpha": wider}, self.masking) for i in slices])
        shape = (len(self.weights), *CELLS, PER_CELL, 3)
        peak = truth.reshape(shape).max(axis=-2, keepdims=True)
        step = roughness_step(forth.reshape(shape), after.reshape(shape), STEP, peak)
        return self.map(
            "smooth in roughness",
            step.max(axis=-1),
            why="A lobe's logarithm has bounded slopes in that of alpha, so a wider one is nearly "
            "the same; a jump would show as a line where roughness is painted.",
            unit="step of f over a thousandth of alpha, over the largest that the model allows",
            limit=1.0,
            reproduce=lambda at: [
                self.shown(at),
                self.shown(at, alpha=self.shown(at)["alpha"] * np.float32(1 + STEP)),
            ],
        )


def largest_end(inputs: Inputs, masking: str) -> np.ndarray:
    """The largest f of all pairs of one lobe for D and one for G, (n, 3)."""
    ends = [
        exact("brdf", inputs | {"weight": d, "weight_g": g}, masking)
        for d in ((1, 0), (0, 1))
        for g in ((1, 0), (0, 1))
    ]
    return np.max(ends, axis=0)


def weight_step(
    before: np.ndarray, after: np.ndarray, step: float, largest: np.ndarray
) -> np.ndarray:
    """A step of f where weight moves, over the largest that `smooth_in_weight` allows."""
    return _over(before, after, (4 * step + ROUNDING) * largest)


def roughness_step(
    before: np.ndarray, after: np.ndarray, step: float, peak: np.ndarray
) -> np.ndarray:
    """A step of f where alpha grows by a share, over the most that `smooth_in_roughness` allows."""
    return _over(before, after, (4 * step + ROUNDING) * peak)


def _over(before: np.ndarray, after: np.ndarray, allowed: np.ndarray) -> np.ndarray:
    """A step over what is allowed; no step is 0, whatever is allowed."""
    with np.errstate(invalid="ignore", divide="ignore"):
        step = np.abs(after - before)
        return np.where(step == 0, 0, step / allowed)


def stock_maps() -> Iterator[Map]:
    """Single lobes beside Mitsuba's own roughconductor: f with F = 1, and the samples' density."""
    sweep = Sweep("smith", np.array([0.0, 1.0]))
    known = half_vector(sweep.wi, sweep.wo)[1].reshape(*CELLS, PER_CELL) >= STOCK_KNOWN
    where = (
        f"compared where wi.h is at least {STOCK_KNOWN}, since its own dot products cancel below."
    )
    sampled = {n: v for n, v in sweep.inputs(0).items() if n in ("wi", "wo", "alpha")}
    counts = ((0, 1, 0), (1, 0, 0))
    densities = []
    for slice_, (ndf, title) in enumerate((("beckmann", "Beckmann"), ("ggx", "GGX"))):
        inputs = sweep.inputs(sweep.weights[slice_]) | WHITE_METAL
        f, pdf = stock(inputs, ndf)
        ours = shader("sample_density", sampled | {"count": counts[slice_]})
        densities.append(np.where(known, difference(ours, pdf, CELLS), 0))
        off = difference(shader("brdf", inputs, "smith")[:, :1], f, CELLS)
        yield make_map(
            "brdf",
            f"against roughconductor, {title}",
            np.where(known, off, 0)[None],
            (axis("weight", [sweep.weights[slice_]]), COSINE, ALPHA),
            lambda at, k=slice_: [sweep.shown((k, *at[1:]), **WHITE_METAL)],
            masking="smith",
            why="A plugin that nobody here wrote has the same model where one lobe has all of the "
            f"weight and F = 1; {where}"
            + " Its G1 of Beckmann is a fit, .35 % off."
            * (ndf == "beckmann"),
            unit=SCALE,
            limit=TOLERANCE if ndf == "ggx" else STOCK_BECKMANN,
            judged=JUDGED,
        )

    def reproduce(at):
        shown = sweep.shown(at)
        return [{n: shown[n] for n in ("wi", "wo", "alpha")} | {"count": counts[at[0]]}]

    yield make_map(
        "sample_density",
        "pdf against Mitsuba",
        np.stack(densities),
        (axis("weight", sweep.weights), COSINE, ALPHA),
        reproduce,
        why="Light is divided by the samples' density, so an error in it is one in the picture; "
        f"roughconductor's, {where}",
        unit=SCALE,
        limit=TOLERANCE,
        judged=JUDGED,
    )


def _swapped(inputs: Shown) -> Shown:
    return inputs | {"wi": inputs["wo"], "wo": inputs["wi"]}
