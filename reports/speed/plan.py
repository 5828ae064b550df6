"""A plan: per case the technique that a bench shows to be enough, written as a suite."""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import tomlkit

from reports.speed.points import Bench, Point, case_digest
from scenes.environment import FORMATS
from scenes.errors import InputError
from scenes.schema import Case
from scenes.suite import AXES, Budget, Run, Suite, Sweep, expand

Measure = Literal["energy_local", "ssim"]
# The figure of a point's errors that falls as the picture gets better.
ERRORS = {"energy_local": "energy_local", "ssim": "one_minus_ssim"}
MADE_ANEW = "run `shadeproof bench` anew"


@dataclass(frozen=True)
class Goal:
    """What a technique must reach: an error that it may have, or a time that it may take.

    Attributes:
        figure: the error is that of energy_local, or 1 - SSIM for "ssim".
        max_error: the largest error that passes, for every object, at the end of its interval.
        max_seconds: the longest warm frame that passes; exactly one of the two is given.
    """

    figure: Measure
    max_error: float | None = None
    max_seconds: float | None = None

    def error(self, point: Point) -> float:
        """The upper end of the 95 % interval, of the worst object; infinite if it is unknown."""
        highs = [getattr(e, ERRORS[self.figure]).high for e in point.errors]
        return max((math.inf if math.isnan(h) else h for h in highs), default=math.inf)

    def met(self, point: Point) -> bool:
        """Whether a point is good enough; one without a known error or time never is."""
        if self.max_error is not None:
            return self.error(point) <= self.max_error and math.isfinite(point.frame.median)
        return point.frame.median <= self.max_seconds and math.isfinite(self.error(point))

    def best(self, points: Sequence[Point]) -> Point:
        """Of points that meet it the best: the cheapest, or under a time the least wrong."""
        found = [p for p in points if self.met(p)]
        if self.max_error is not None:
            return min(found, key=lambda p: (p.frame.median, self.error(p)))
        return min(found, key=lambda p: (self.error(p), p.frame.median))

    def nearest(self, points: Sequence[Point]) -> Point:
        """Of points that do not meet it the one that comes nearest."""
        if self.max_error is not None:
            return min(points, key=self.error)
        return min(points, key=lambda p: p.frame.median)

    def told(self, point: Point) -> str:
        """What a point was measured to cost and to err, in words."""
        time, error = f"{point.frame.median * 1e3:.3g} ms a frame", self.error(point)
        up_to = f"up to {error:.3g}" if math.isfinite(error) else "unknown"
        return f"{point.name}, {time}, {ERRORS[self.figure]} {up_to}"


class OutOfReachError(Exception):
    """No technique of the bench meets the goal: a verdict, not a mistake."""


def chosen(bench: Bench, goal: Goal) -> dict[str, Point]:
    """The technique that meets a goal, by case.

    Raises:
        OutOfReachError: some case has none; the nearest to it is named.
    """
    cases: dict[str, list[Point]] = {}
    for point in bench.points:
        if point.family == "real-time":
            cases.setdefault(point.case, []).append(point)
    missed = [c for c, points in cases.items() if not any(map(goal.met, points))]
    if missed:
        nearest = goal.told(goal.nearest(cases[missed[0]]))
        others = f", nor of {len(missed) - 1} further cases" if len(missed) > 1 else ""
        raise OutOfReachError(f"no technique of {missed[0]}{others} meets it; nearest: {nearest}")
    return {c: goal.best(points) for c, points in cases.items()}


def planned(
    suite: Suite, path: Path, picked: dict[str, Point], goal: Goal, environments: Sequence[str] = ()
) -> Suite:
    """A suite of the cases that were measured, each with the technique picked for it.

    All that `suite` says of them is carried through; truth is `global`, which the errors were
    measured against, and the goal's error is the budget.

    Args:
        suite, path: what the bench was made of; relative paths in it become absolute.
        environments: others, to check the plan where it was not made. Where cases that differ in
            their environment alone fall together there, the slowest technique of them is taken.

    Raises:
        InputError: the suite has no such case any more, or draws another one by its name; or two
            environments have one name.
    """
    known = [(_case(suite, run, path), _absolute(run, path.parent)) for run in _single(suite)]
    if gone := sorted(set(picked) - {case.id for case, _ in known}):
        raise InputError(path, "run", f"has no case '{gone[0]}' any more", MADE_ANEW)
    for case, _ in known:
        if case.id in picked and picked[case.id].digest not in ("", case_digest(case)):
            problem = f"does not draw '{case.id}' as it was measured"
            raise InputError(path, "run", problem, MADE_ANEW)
    runs: dict[str, tuple[float, Run, Path]] = {}
    for case, run in known:
        if case.id not in picked:
            continue
        point = picked[case.id]
        for light in (*run.environments, *environments):
            update = {"environments": (light,), "techniques": (point.name,)}
            other = run.model_copy(update=update | {"truths": None, "split_model": False})
            made = _case(suite, other, path)
            under, file = made.id, made.environment.path
            if under in runs and runs[under][2] != file:
                problem = f"makes another case '{under}'"
                raise InputError("--environment", light, problem, "rename the file")
            # What was measured under an environment goes before what is carried over to it.
            cost = math.inf if light in run.environments else point.frame.median
            if under not in runs or cost > runs[under][0]:
                runs[under] = cost, other, file
    techniques = tuple(dict.fromkeys(p.name for p in picked.values()))
    return Suite(
        description=f"Planned from {path.stem}: {_goal(goal)}.",
        techniques=techniques,
        truths=("global",),
        allow_inconclusive=suite.allow_inconclusive,
        model=suite.model,
        reference=suite.reference,
        run=tuple(run for _, run, _ in runs.values()),
        budget=_budgets(goal, techniques),
    )


def text(plan: Suite, picked: dict[str, Point], goal: Goal, command: str) -> str:
    """The plan as TOML, headed by comments: how it was made and what was measured."""
    told = [command, *(f"{case}: {goal.told(point)}" for case, point in picked.items())]
    fields = plan.model_dump(mode="json", exclude_defaults=True)
    return "".join(f"# {' '.join(t.split())}\n" for t in told) + "\n" + tomlkit.dumps(fields)


def _goal(goal: Goal) -> str:
    if goal.max_error is not None:
        return f"the cheapest technique whose {ERRORS[goal.figure]} is at most {goal.max_error:g}"
    longest = f"{goal.max_seconds * 1e3:g} ms a frame"
    return f"the technique of least {ERRORS[goal.figure]} that takes at most {longest}"


def _budgets(goal: Goal, techniques: Sequence[str]) -> tuple[Budget, ...]:
    """The goal's error as a budget for each technique; a time is no budget of a suite."""
    if goal.max_error is None:
        return ()
    limit = 1 - goal.max_error if goal.figure == "ssim" else goal.max_error
    return tuple(Budget(technique=t, truth="global", **{goal.figure: limit}) for t in techniques)


def _single(suite: Suite) -> Iterator[Run]:
    """Every crossing of every run, as a run of one case."""
    for run in suite.run:
        axes = {axis: values for axis in AXES if (values := getattr(run.sweep, axis))}
        crossing = itertools.product(run.environments, run.materials or (None,), *axes.values())
        for light, material, *values in crossing:
            sweep = {axis: (value,) for axis, value in zip(axes, values, strict=True)}
            yield run.model_copy(
                update={
                    "environments": (light,),
                    "materials": (material,) if material else (),
                    "sweep": Sweep(**sweep),
                }
            )


def _case(suite: Suite, run: Run, path: Path) -> Case:
    """The one case of a run."""
    alone = run.model_copy(update={"truths": None, "split_model": False})
    (entry,) = expand(suite.model_copy(update={"run": (alone,)}), path)
    return entry.case


def _absolute(run: Run, home: Path) -> Run:
    """A run whose files are named so that a suite in any folder finds them."""

    def moved(names: Sequence[str], endings: tuple[str, ...]) -> tuple[str, ...]:
        by_path = [Path(n).suffix.lower() in endings for n in names]
        return tuple(
            str((home / n).resolve()) if b else n for n, b in zip(names, by_path, strict=True)
        )

    update = {
        "scene": moved((run.scene,), (".toml",))[0],
        "environments": moved(run.environments, FORMATS),
        "materials": moved(run.materials, (".toml",)),
    }
    return run.model_copy(update=update)
