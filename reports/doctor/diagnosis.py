"""Which mistakes explain pictures: those with which our own renderer draws the same.

A mistake is tried by making it: the case is changed as the mistake changes it, drawn by our own
renderer, and the picture regraded. What then comes nearest to the candidate names what is wrong; on
top of that the next one is tried, until nothing more is explained.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from reports.doctor.mistakes import MISTAKES, OTHER_TURNS, Mistake, gain_near
from reports.doctor.scenes import SOUND
from scenes.frame import Frame
from scenes.schema import Case

Draw = Callable[[Case], Frame]  # with object ids
Found = tuple[Mistake, ...]
LEAST_GAIN = 0.05  # in the logarithm
EXPLAINS = 0.7  # of what was off is left, at most, where a mistake counts as found
LEAST = 0.3  # of what honest renderers differ by is explained, at least
MOST = 4  # mistakes at once
HIDE_TURNS = {"map", "flip", "view"}
FLOOR = 0.3  # of a picture's median light: far below that differences hardly count


@dataclass(frozen=True)
class Diagnosis:
    """What is wrong with a candidate.

    Attributes:
        found: the mistakes, the one that explains most first.
        before, after: how far each case's picture is off, without and with them: RMS of log
            light, in multiples of what is sound (SOUND).
        lost: cases without a usable picture, and why.
    """

    found: Found
    before: Mapping[str, float]
    after: Mapping[str, float]
    lost: Mapping[str, str]

    @property
    def sound(self) -> bool:
        """Whether nothing is wrong."""
        return not self.found and self.explained

    @property
    def explained(self) -> bool:
        """Whether what was found explains all that is off."""
        return not self.lost and max(self.after.values(), default=2.0) <= 1


def diagnose(
    cases: Mapping[str, Case],
    pictures: Mapping[str, np.ndarray],
    lost: Mapping[str, str],
    draw: Draw,
    folder: Path,
) -> Diagnosis:
    """Find the mistakes that explain a candidate's pictures.

    Args:
        cases: the doctor's cases by name.
        pictures: (h, w, 3) linear light of those that the candidate drew.
        lost: why it drew no others.
        draw: our own renderer.
        folder: for the files of changed cases.
    """
    seen = _Seen(cases, pictures, draw, folder)
    found: Found = ()
    before = seen.off_each(found)
    after, best = before, seen.off(found)
    while pictures and max(after.values()) > 1 and len(found) < MOST:
        more, left = _next(seen, found, best)
        if left > min(EXPLAINS * best, best - LEAST):
            break
        found, best = (*found, *more), left
        after = seen.off_each(found)
    return Diagnosis(found, before, after, lost)


def _next(seen: "_Seen", found: Found, best: float) -> tuple[Found, float]:
    """What explains most of what is left, and how much then is left.

    Mistakes are tried one by one; where that does not help, a turn together with another mistake
    of the map, the picture or the view, each of which hides the other.
    """
    kinds = {m.kind for m in found}
    single: list[Found] = [(m,) for m in MISTAKES if m.kind not in kinds]
    if "gain" not in kinds and (factor := seen.factor(found)):
        single.append((gain_near(factor),))
    more, left = _best(seen, found, single)
    if "turn" in kinds or (left <= EXPLAINS * best and more[0].kind != "turn"):
        return more, left
    turns = [m for m in MISTAKES if m.kind == "turn"]
    hidden = [m for m in MISTAKES if m.kind in HIDE_TURNS - kinds]
    tried = [(t,) for t in OTHER_TURNS]
    if left > EXPLAINS * best:
        tried += [(turn, other) for turn in turns for other in hidden]
    again, remains = _best(seen, found, tried)
    return (again, remains) if remains < left else (more, left)


def _best(seen: "_Seen", found: Found, tried: Iterable[Found]) -> tuple[Found, float]:
    """Of sets of further mistakes that which leaves least; none of them leaves everything."""
    ranked = [(seen.off((*found, *more)), more) for more in tried]
    left, more = min(ranked, key=lambda pair: pair[0], default=(np.inf, ()))
    return more, left


class _Seen:
    """The candidate's pictures, and what ours become under mistakes."""

    def __init__(
        self,
        cases: Mapping[str, Case],
        pictures: Mapping[str, np.ndarray],
        draw: Draw,
        folder: Path,
    ) -> None:
        self.cases, self.pictures, self.draw, self.folder = cases, pictures, draw, folder
        self.drawn: dict[str, Frame] = {}

    def off(self, mistakes: Found) -> float:
        """How far the candidate is from ours under mistakes: RMS over the cases."""
        each = self.off_each(mistakes).values()
        return float(np.sqrt(np.mean(np.square([*each])))) if each else np.inf

    def off_each(self, mistakes: Found) -> dict[str, float]:
        """The same case by case: RMS difference of log light on the objects, over SOUND."""
        found = {}
        for name in self.pictures:
            apart = self._log(name, *self.ours(name, mistakes))
            found[name] = float(np.sqrt(np.mean(apart**2))) / SOUND[name]
        return found

    def factor(self, mistakes: Found) -> float:
        """The median of how much brighter the candidate is; 0 where that is little."""
        ratios = []
        for name, picture in self.pictures.items():
            ours, on = self.ours(name, mistakes)
            bright = on[..., 0] & (ours.mean(axis=2) > np.median(ours[on[..., 0]]))
            theirs = np.nan_to_num(picture[bright], nan=0.0, posinf=1e9, neginf=0.0)
            ratios.append(np.log(np.maximum(theirs, 1e-9) / np.maximum(ours[bright], 1e-9)).ravel())
        factor = float(np.exp(np.median(np.concatenate(ratios)))) if ratios else 1.0
        return factor if abs(np.log(factor)) > LEAST_GAIN else 0.0

    def ours(self, name: str, mistakes: Found) -> tuple[np.ndarray, np.ndarray]:
        """Our picture (h, w, 3) of a case under mistakes, and where its objects are."""
        case = self.cases[name]
        for mistake in mistakes:
            case = mistake.case(case, self.folder)
        key = case.model_dump_json()
        if key not in self.drawn:
            self.drawn[key] = self.draw(case)
        frame = self.drawn[key]
        rgb, on = frame.rgb, np.repeat((frame.ids > 0)[..., None], 3, axis=2)
        for mistake in sorted(mistakes, key=lambda m: m.order):
            rgb = mistake.picture(rgb)
            if mistake.kind == "flip":
                on = mistake.picture(on)
        return rgb, on

    def _log(self, name: str, ours: np.ndarray, on: np.ndarray) -> np.ndarray:
        """log of the candidate's light over ours, (p, 3), on the objects."""
        inside = on[..., 0]
        floor = max(FLOOR * float(np.median(ours[inside])), 1e-9)
        theirs = np.nan_to_num(self.pictures[name], nan=0.0, posinf=1e9, neginf=0.0)
        return np.log(np.maximum(theirs[inside], 0) + floor) - np.log(ours[inside] + floor)
