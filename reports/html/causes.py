"""Error by cause in words and signed bars: the block 'Why' of a case."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from reports.candidates import OUTSIDE
from reports.html.figures import GAP, half_width, number
from reports.results import Cause, Figured, Ladder

MEANINGS = {
    "integration": "The technique adds up the environment's light only roughly, even where nothing "
    "is in the way.",
    "irradiance map": "The small map of diffuse light.",
    "kd at n·v": "One share of diffuse light for all directions, taken at the angle of view.",
    "table": "The table of the specular lobe's reflectance.",
    "prefilter": "The blurred environment, looked up in one direction as if seen head-on.",
    "occlusion": "Light that in truth is blocked by the object itself or by its neighbours; where "
    "the technique draws shadows, what is wrong with them.",
    "interreflection": "Light that in truth arrives by way of the object itself or its neighbours; "
    "where the technique draws it, what is wrong with it.",
    "model": "The surface itself: the case's BRDF instead of physical materials; where the "
    "technique draws their equations, what is wrong with these.",
    "Fresnel": "Schlick's approximation instead of the exact equations.",
    "kd": "The share of light that the diffuse layer gets and gives back.",
    "masking": "The masking of facets, where the case's is not the mixture's exact Smith masking, "
    "and all else that parts the models.",
}
ABSENT = {"occlusion": "shadows", "interreflection": "light between surfaces"}
CANCELS = 0.01  # of the light, from which on errors of opposite sign are told
SKEW = 4 / 3  # of an interval's sides, from which on both are told
HIDDEN = 0.5  # half an interval beyond which a fraction says nothing


@dataclass(frozen=True)
class Measure:
    """What bars show: the field of Cause, its heading, how to read its two sides, its unit."""

    field: str
    heading: str
    reading: str
    unit: Literal["%", ""]
    decimals: int

    def number(self, value: float, decimals: int | None = None) -> str:
        """A signed number without its unit; 0 has no sign."""
        shown = self.decimals if decimals is None else decimals
        rounded = round(self.scaled(value), shown) + 0.0  # no negative zero
        return number(rounded, shown, signed=rounded != 0)

    def scaled(self, value: float) -> float:
        """A figure in the measure's unit."""
        return 100 * value if self.unit else value

    def with_unit(self, text: str) -> str:
        """A number as text, and its unit."""
        return f"{text}{GAP}{self.unit}" if self.unit else text

    def spread(self, figure: Figured) -> str:
        """Half the interval as ±, or both sides of a skew one, with the unit."""
        half, least = self.scaled(half_width((figure.low, figure.high))), 10**-self.decimals
        if not math.isfinite(half):
            return f"±{GAP}unknown"
        below, above = (self.scaled(s) for s in _sides(figure))
        sides = number(below, self.decimals), number(above, self.decimals)
        if _skew(figure) and sides[0] != sides[1]:
            return self.with_unit(f"−{sides[0]}/+{sides[1]}")
        shown = number(half, self.decimals) if half >= least / 2 else f"<{GAP}{least:g}"
        return f"±{GAP}{self.with_unit(shown)}"


def _sides(figure: Figured) -> tuple[float, float]:
    """How far an interval reaches below and above its figure."""
    return max(figure.value - figure.low, 0.0), max(figure.high - figure.value, 0.0)


def _skew(figure: Figured) -> bool:
    """Whether the sides of an interval differ by more than a third."""
    small, large = sorted(_sides(figure))
    return large > SKEW * small


MEASURES = (
    Measure("local", "Local energy error", "left of 0: makes up for others", "%", 1),
    Measure("energy", "Total energy error", "left: too dark, right: too bright", "%", 1),
    Measure("ssim", "SSIM", "left: likeness lost", "", 3),
)


@dataclass(frozen=True)
class Span:
    """A stretch of an axis, in percent of its length; `kind` is how it is drawn."""

    start: float
    length: float
    kind: str = ""


@dataclass(frozen=True)
class Axis:
    """The values between the two ends of a bar's track, 0 among them."""

    low: float
    high: float

    @property
    def zero(self) -> float:
        """Where 0 lies, in percent of the length."""
        return self.at(0)

    def at(self, value: float) -> float:
        """Where a value lies, in percent of the length."""
        place = (value - self.low) / (self.high - self.low)
        return round(100 * min(max(place, 0), 1), 1)

    def span(self, a: float, b: float, kind: str = "") -> Span:
        """The stretch between two values."""
        start, end = sorted((self.at(a), self.at(b)))
        return Span(start, round(end - start, 1), kind)

    def ticks(self, measure: Measure) -> list[tuple[float, str]]:
        """Places and labels of 0 and of those ends that are far enough from it to be read."""
        ends = [(v, self.at(v)) for v in (self.low, self.high) if abs(self.at(v) - self.zero) > 25]
        places = sorted([*ends, (0.0, self.zero)])
        return [(p, measure.with_unit(measure.number(v, _places(measure, v)))) for v, p in places]


@dataclass(frozen=True)
class Bar:
    """One figure of a cause: its bar on an axis and the number beside it; no bar, no figure.

    Attributes:
        zero: where 0 lies, in percent of the axis.
        noise: whether noise hides the sign, or the interval is unknown.
        unknown: whether the interval is unknown.
        split: diffuse and specular light in words; empty where they are not told apart.
    """

    zero: float
    spans: list[Span]
    whisker: Span | None
    text: str
    spread: str
    noise: bool
    unknown: bool
    split: str


@dataclass(frozen=True)
class Line:
    """One row of a chart; `part` where it is a part of the cause above."""

    name: str
    meaning: str
    part: bool
    bars: list[Bar | None]


@dataclass(frozen=True)
class Chart:
    """One object's causes under one technique."""

    object: str
    technique: str
    truth: str
    switched: bool
    sentences: list[str]
    closure: str
    closes: bool
    heads: list[tuple[Measure, list[tuple[float, str]]]]
    lines: list[Line]

    @property
    def split(self) -> bool:
        """Whether any of its bars tells diffuse light apart."""
        return any(bar and bar.split for line in self.lines for bar in line.bars)


def charts(ladders: Sequence[Ladder]) -> list[Chart]:
    """A case's ladders, as charts on common scales: objects and techniques can be compared."""
    axes = [_axis(ladders, measure) for measure in MEASURES]
    return [_chart(found, axes) for found in ladders]


def part_meanings(shown: Sequence[Chart]) -> dict[str, str]:
    """What the parts mean that charts show."""
    parts = dict.fromkeys(line.name for c in shown for line in c.lines if line.part)
    return {name: MEANINGS[name] for name in parts if name in MEANINGS}


def _chart(ladder: Ladder, axes: Sequence[Axis]) -> Chart:
    return Chart(
        object=ladder.object,
        technique=ladder.technique,
        truth=ladder.truth,
        switched=bool(ladder.switched),
        sentences=[*_sentences(ladder)],
        closure=_closure(ladder),
        closes=ladder.closes or not _known(ladder.energy_gap, ladder.local_gap),
        heads=[(m, axis.ticks(m)) for m, axis in zip(MEASURES, axes, strict=True)],
        lines=[_line(c, axes) for c in [*ladder.causes, ladder.total] if not _nothing(c)],
    )


def _nothing(cause: Cause) -> bool:
    """Whether a part is nought without any noise: a lobe or map that the material has not."""
    figures = (cause.energy, cause.local)
    return bool(cause.parent) and all(f.value == f.low == f.high == 0 for f in figures)


def _line(cause: Cause, axes: Sequence[Axis]) -> Line:
    bars = [_bar(cause, m, axis) for m, axis in zip(MEASURES, axes, strict=True)]
    return Line(cause.name, MEANINGS.get(cause.name, ""), bool(cause.parent), bars)


def _bar(cause: Cause, measure: Measure, axis: Axis) -> Bar | None:
    figure: Figured | None = getattr(cause, measure.field)
    if figure is None or not math.isfinite(figure.value):
        return None
    diffuse = cause.diffuse.value if measure.field == "energy" and cause.diffuse else None
    if diffuse is None:
        spans, told = [axis.span(0, figure.value, "whole")], ""
    else:
        specular = figure.value - diffuse
        spans = _stacked(axis, diffuse, specular)
        told = f"diffuse {measure.number(diffuse)}, specular {measure.number(specular)}"
    known = _known(figure)
    text, spread = measure.number(figure.value), measure.spread(figure)
    return Bar(
        zero=axis.zero,
        spans=[s for s in spans if s.length],
        whisker=axis.span(figure.low, figure.high) if known else None,
        text=text,
        spread=spread,
        noise=not known or (figure.low <= 0 <= figure.high and cause.name != "total"),
        unknown=not known,
        split=told,
    )


def _stacked(axis: Axis, diffuse: float, specular: float) -> list[Span]:
    """Both parts end to end from 0 where their signs agree, else each on its own side."""
    start = diffuse if diffuse * specular > 0 else 0.0
    return [axis.span(0, diffuse, "diffuse"), axis.span(start, start + specular, "specular")]


def _axis(ladders: Sequence[Ladder], measure: Measure) -> Axis:
    """An axis that holds 0 and every bar and whisker of a measure, with round ends."""
    ends = [0.0]
    for cause in (c for found in ladders for c in [*found.causes, found.total]):
        if figure := getattr(cause, measure.field):
            ends += [figure.value, figure.low, figure.high]
        if measure.field == "energy" and cause.diffuse:
            ends += [cause.diffuse.value, cause.energy.value - cause.diffuse.value]
    finite = [e for e in ends if math.isfinite(e)]
    low, high = min(finite), max(finite)
    if low == high:
        return Axis(-1, 1)
    step = 10 ** math.floor(math.log10(high - low))
    step = next(s for s in (step / 10, step / 5, step / 2, step) if (high - low) / s <= 10)
    return Axis(math.floor(low / step) * step, math.ceil(high / step) * step)


def _places(measure: Measure, value: float) -> int:
    """Decimals that an axis' round end needs."""
    shown = abs(measure.scaled(value))
    return next(d for d in range(6) if d == 5 or abs(round(shown, d) - shown) < 1e-9)


def _known(*figures: Figured) -> bool:
    """Whether all have an interval."""
    return all(math.isfinite(f.high - f.low) for f in figures)


def _sentences(ladder: Ladder) -> Iterable[str]:
    """What the bars say, in words."""
    causes = [c for c in ladder.causes if not c.parent]
    total = ladder.total.local
    if not _known(total) or not total.value > 0:
        yield "The local error is lost in the reference's noise."
    else:
        yield _local(_Balance.of(causes, ladder.total, "local"))
    yield from _by_pattern(ladder) if ladder.technique == OUTSIDE else _by_switches(ladder)
    over = sum(c.energy.value for c in causes if c.energy.low > 0)
    under = sum(c.energy.value for c in causes if c.energy.high < 0)
    if min(over, -under) > CANCELS:
        balance = _Balance.of(causes, ladder.total, "energy")
        sides = f"{_and(balance.over)} against {_and(balance.under)}"
        left = f"{balance.left}{GAP}%{balance.remark}"
        yield f"In the total, errors cancel: {sides}, which leaves {left}."


@dataclass(frozen=True)
class _Balance:
    """All causes that a figure shows, largest first, by sign, and what they leave.

    `remark` is empty where the shown numbers sum to what is left, digit for digit.
    """

    over: list[str]
    under: list[str]
    left: str
    remark: str

    @staticmethod
    def of(causes: Sequence[Cause], total: Cause, field: Literal["local", "energy"]) -> "_Balance":
        def rounded(cause: Cause) -> float:
            return round(100 * getattr(cause, field).value, 1)

        shown = sorted((c for c in causes if abs(rounded(c)) > 0), key=lambda c: -abs(rounded(c)))
        named = [(rounded(c), f"{c.name} {number(rounded(c), 1, signed=True)}") for c in shown]
        left = rounded(total)
        exact = abs(sum(value for value, _ in named) - left) < 0.05
        return _Balance(
            over=[text for value, text in named if value > 0],
            under=[text for value, text in named if value < 0],
            left=number(left + 0.0, 1, signed=field == "energy" and left != 0),
            remark="" if exact else ", to rounding and noise",
        )


def _local(balance: _Balance) -> str:
    """The causes of the local error; those that make up for others stand apart."""
    left = f"a local error of {balance.left}{GAP}%{balance.remark}"
    told = _and(balance.over)
    if not told:
        return f"No cause stands out in {left}."
    told, several = told[0].upper() + told[1:], len(balance.over) > 1
    if balance.under:
        undone = "are partly undone by" if several else "is partly undone by"
        return f"{told} {undone} {_and(balance.under)}, leaving {left}."
    return f"{told} {'make' if several else 'makes'} {left}."


def _and(names: Sequence[str]) -> str:
    """A list in words."""
    return " and ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))


def _by_switches(ladder: Ladder) -> Iterable[str]:
    """What of the truth's light a technique draws, whose switches are known."""
    causes = [c.name for c in ladder.causes if c.name in ABSENT]
    if lacks := [f"no {ABSENT[name]}" for name in causes if name not in ladder.switched]:
        yield f"This technique draws {_and(lacks)}."
    known = {n: f for n, f in _told(ladder).items() if n in ladder.switched}
    drawn = [Figured(value=1 - f.value, low=1 - f.high, high=1 - f.low) for f in known.values()]
    shares = [f"{_share(f)} of the {ABSENT[n]}" for n, f in zip(known, drawn, strict=True)]
    if shares:
        yield f"With its switches on, it draws {_and(shares)}, by least squares over the blocks."


def _by_pattern(ladder: Ladder) -> Iterable[str]:
    """What of the truth's light a picture alone seems to lack, where noise does not hide it."""
    if told := _and([f"{_share(f)} of the {ABSENT[name]}" for name, f in _told(ladder).items()]):
        yield (
            f"By the pattern of its blocks, the picture lacks {told}; its other errors can look "
            "like these, so that a figure beside 100 % need not mean that some is drawn."
        )


def _told(ladder: Ladder) -> dict[str, Figured]:
    """The missing fractions that say something."""
    return {n: f for n, f in ladder.missing.items() if half_width((f.low, f.high)) <= HIDDEN}


def _share(figure: Figured) -> str:
    """A fraction with its spread."""
    shares = (figure.value, half_width((figure.low, figure.high)), *_sides(figure))
    value, half, below, above = (number(100 * v, 0) for v in shares)
    spread = f"±{GAP}{half}" if below == above or not _skew(figure) else f"−{below}/+{above}"
    return f"{value}{GAP}{spread}{GAP}%"


def _closure(ladder: Ladder) -> str:
    """Whether steps and total, from different batches, agree."""
    if not _known(ladder.energy_gap, ladder.local_gap):
        return "Too few batches to say whether the steps sum to the total."
    gaps = ladder.local_gap, ladder.energy_gap
    local, total = map(_gap, gaps)
    told = f"the gap is {local} of local and {total} of total energy"
    if not ladder.closes:
        doubt = "Batches of a reference disagree, so do not trust these bars."
        return f"The steps do NOT sum to the total: {told}. {doubt}"
    if all(g.low <= 0 <= g.high for g in gaps):
        return f"Steps and total, from different batches, agree within the noise: {told}."
    return f"Steps and total, from different batches, differ as one in twenty may: {told}."


def _gap(figure: Figured) -> str:
    """A gap with its spread, to hundredths of a percent."""
    half = half_width((figure.low, figure.high))
    return f"{number(100 * figure.value, 2, signed=True)}{GAP}±{GAP}{number(100 * half, 2)}{GAP}%"
