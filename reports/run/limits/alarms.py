"""False alarms: pictures that are right, judged on sets of batches."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from renderer.draw import Renderer
from renderer.techniques import Technique
from reports.limits.detection import CAUGHT, INCONCLUSIVE, share_interval
from reports.limits.results import FalseAlarms
from reports.progress import reporting
from reports.run.limits.judging import VERDICTS, Gate, Place, clearance
from reports.run.shots import shots
from scenes.frame import Frame

ASKED = 7.0  # a row that passes by more half widths is left out; see FAR


def _finer(how: Technique) -> Technique:
    """The same with four times the directions, or 2x2 pixels a pixel where it samples none."""
    return replace(how, samples=4 * how.samples) if how.samples else replace(how, supersample=2)


def _rounded(frame: Frame) -> Frame:
    """To the eleven bits of a half float, of any size: suns pass what half floats can hold."""
    mantissa, exponent = np.frexp(frame.rgb)
    return replace(frame, rgb=np.ldexp(np.round(mantissa * 2048) / 2048, exponent))


HARMLESS: dict[str, tuple[Callable[[Technique], Technique], Callable[[Frame], Frame]]] = {
    "the renderer as it is": (lambda how: how, lambda frame: frame),
    "four times the directions, or 2x2 pixels a pixel": (_finer, lambda frame: frame),
    "rounded to eleven bits, as half floats are": (lambda how: how, _rounded),
}


def false_alarms(gate: Gate, orders: np.ndarray) -> list[FalseAlarms]:
    """How often the gate fails pictures that are right.

    Args:
        orders: (sets, M) the batches of each set.
    """
    told = []
    with reporting(len(HARMLESS)) as report:
        for what in HARMLESS:
            report.step(f"false alarms: {what}")
            outcomes = np.zeros(len(orders), int)
            for place, frame in _near(gate, what):
                said = [VERDICTS[gate.row(place, frame, order).verdict] for order in orders]
                outcomes = np.maximum(outcomes, said)
            told.append(_told(what, outcomes))
    return told


def _near(gate: Gate, what: str) -> list[tuple[Place, Frame]]:
    """The rows that are asked, and their pictures: all but those that are far within budgets."""
    near = []
    for number in range(len(gate.pools)):
        for label in gate.pools[number].entry.techniques:
            frames = _drawn(gate, number, what, label)
            rows = gate.budgeted(number, label, frames)
            near += [(p, frames[p.truth]) for p, row in rows.items() if clearance(row)[0] > -ASKED]
    return near


def _drawn(gate: Gate, number: int, what: str, label: str) -> dict[str, Frame]:
    """A technique's pictures of a case by truth."""
    how, kept = HARMLESS[what]
    pool = gate.pools[number]
    against = shots(label, pool.entry.case, pool.truths, timed=False)
    pictures = {
        shot.name: kept(Renderer(how(shot.candidate.technique), repeats=0).render(shot.case))
        for shot in {shot.name: shot for shot in against.values()}.values()
    }
    return {truth: pictures[shot.name] for truth, shot in against.items()}


def _told(what: str, outcomes: np.ndarray) -> FalseAlarms:
    alarms = int((outcomes == CAUGHT).sum())
    low, high = share_interval(alarms, len(outcomes))
    unsure = int((outcomes == INCONCLUSIVE).sum())
    return FalseAlarms(
        what=what, sets=len(outcomes), alarms=alarms, inconclusive=unsure, low=low, high=high
    )
