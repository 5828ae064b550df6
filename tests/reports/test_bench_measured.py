"""Times and errors of a bench: who is drawn when, and what is told of it."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from reports.noise import Estimate
from reports.run.bench.errors import Judged, pooled
from reports.run.bench.measured import PICTURES, Measured, lacking, measure, timed
from reports.run.bench.way import Cost, Way
from scenes.suite import expand, load_suite
from tests.reports.small import BUNNY


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(BUNNY)
    (entry,) = expand(*load_suite(str(path)))
    return entry.case


class Scripted(Way):
    """A way whose frames take what a script says, and that remembers their seeds."""

    family = "path traced"

    def __init__(self, name, seconds, noisy, calls):
        self.name, self.seconds, self.noisy, self.calls = name, seconds, noisy, calls

    def frame(self, seed):
        self.calls.append((self.name, seed))
        return self.seconds

    def picture(self):
        return np.ones((64, 64, 3), np.float32)

    def cost(self, frame):
        return Cost()


@pytest.fixture
def scripted(case, monkeypatch):
    """The calls of one long and noisy and one short and still way in 4 rounds, and the result."""
    exact = Judged(*[Estimate(0.1)] * 3)
    monkeypatch.setattr("reports.run.bench.measured.judged", lambda *_: exact)
    calls = []
    ways = [Scripted("long", 1.0, True, calls), Scripted("short", 0.01, False, calls)]
    return calls, measure(case, ways, None, 4, lambda _: None)


def test_ways_take_turns_and_short_frames_are_warmed(scripted):
    calls, (long, short) = scripted
    assert long.seconds == [1.0] * 4 and short.seconds == [0.01] * 4
    order = [name for name, _ in calls[2:]]  # after each has drawn once
    assert order[:3] == ["long", "long", "short"] or order[:4] == ["long", "long", "short", "short"]
    assert order.count("short") == 8 and order.count("long") == 5
    assert order[-1] == "long"  # the first of the odd rounds is the other one


def test_noisy_ways_are_judged_on_several_pictures_of_different_seeds(scripted):
    calls, (long, short) = scripted
    assert [len(m.judged["bunny"]) for m in (long, short)] == [PICTURES, 1]
    seeds = [seed for name, seed in calls if name == "long"]
    assert len(set(seeds)) >= 4


def test_times_are_told_by_median_and_quartiles():
    told = timed([5.0, 1, 2, 3, 4])
    assert (told.low, told.median, told.high, told.frames) == (2, 3, 4, 5)


def test_pictures_share_the_truth_so_its_noise_does_not_average_out():
    alike = pooled([Estimate(0.5, 0.1, 7)] * 4)
    assert alike.value == 0.5 and alike.se == pytest.approx(0.1) and alike.dof == pytest.approx(7)
    apart = pooled([Estimate(0.4, 0.0, 7), Estimate(0.6, 0.0, 7)])
    assert apart.se == pytest.approx(0.1) and apart.dof == pytest.approx(1)
    assert pooled([Estimate(0.5, 0.2, 3)]) == Estimate(0.5, 0.2, 3)


def test_an_object_without_errors_is_named_once(case):
    def seen(name, problem):
        there, away = (Judged(*[Estimate(0, 0, 1)] * 3, p) for p in ("", problem))
        return Measured(SimpleNamespace(name=name), [], {"ball": [there], "moon": [away, away]})

    both = [seen("paper", "is out of the picture"), seen("Mitsuba 1", "is out of the picture")]
    assert lacking(case, both) == ["single.studio, errors of moon: is out of the picture"]
    alone = [both[0], seen("Mitsuba 1", "")]
    assert lacking(case, alone) == [f"{lacking(case, both)[0]} (paper)"]


def test_errors_that_are_unknown_are_told_with_the_reason(case):
    known, unknown = Estimate(0.1, 0.01, 9), Estimate(math.nan, math.nan, 0)
    black = Measured(SimpleNamespace(name="paper"), [], {"ball": [Judged(known, *[unknown] * 2)]})
    (line,) = lacking(case, [black])
    assert "errors of ball: local energy and SSIM unknown: the truth is black" in line
