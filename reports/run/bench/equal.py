"""Equal error: what each family of path tracers needs to be as good as each technique."""

from collections.abc import Iterator

import numpy as np

from reports.run.bench.measured import Measured
from reports.speed.equal_error import Curve, Law, need
from reports.speed.points import EqualError, Family
from scenes.schema import Case

# A figure's errors by the field of reports.run.bench.errors.Judged that holds them.
FIGURES = {"energy_local": "local_square", "one_minus_ssim": "one_minus_ssim"}


def law_of(family: Family, figure: str) -> Law:
    """The square of an estimate without bias falls with a power; nothing else does for sure."""
    return "power" if (family, figure) == ("path traced", "energy_local") else "monotone"


def equal_errors(case: Case, measured: list[Measured]) -> Iterator[EqualError]:
    """Every technique on every object, by every figure, against every family there is."""
    techniques = [m for m in measured if m.way.family == "real-time"]
    families = dict.fromkeys(m.way.family for m in measured if m.way.noisy)
    for obj in case.judged:
        for family in families:
            members = [m for m in measured if m.way.family == family]
            for figure, field in FIGURES.items():
                curve = _curve(members, obj.name, field)
                for technique in techniques:
                    error = getattr(technique.judged[obj.name][0], field)
                    found = need(error, np.array(technique.seconds), curve, law_of(family, figure))
                    yield EqualError(
                        case=case.id,
                        object=obj.name,
                        technique=technique.way.name,
                        against=family,
                        figure=figure,
                        samples=found.samples,
                        seconds=found.seconds,
                        ratio=found.ratio,
                        beyond=found.beyond,
                    )


def _curve(members: list[Measured], name: str, field: str) -> Curve:
    """Error over samples of one object, by a family's members in rising samples."""
    estimates = [[getattr(j, field) for j in m.judged[name]] for m in members]
    return Curve(
        samples=np.array([float(m.way.samples) for m in members]),
        errors=np.array([[e.value for e in row] for row in estimates]),
        noise=np.array([np.mean([e.se for e in row]) for row in estimates]),
        seconds=np.array([m.seconds for m in members]),
    )
