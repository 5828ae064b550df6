"""The Pareto front of time and error."""

import math

from hypothesis import given
from hypothesis import strategies as st

from reports.speed.pareto import Measured, Way, front, standings

UNKNOWN = (math.nan, math.nan)


def way(cost, error, cost_interval=None, error_interval=None):
    return Way(
        Measured(cost, *(cost_interval or (cost, cost))),
        Measured(error, *(error_interval or (error, error))),
    )


def test_what_is_slower_and_worse_is_not_on_the_front():
    ways = [way(4, 1), way(1, 4), way(2, 2), way(3, 3)]
    assert front(ways) == [1, 2, 0]
    assert standings(ways) == ["front", "front", "front", "beaten"]


def test_as_good_but_slower_is_beaten():
    assert front([way(1, 1), way(2, 1), way(1, 2)]) == [0]


def test_equal_ways_share_the_front():
    assert front([way(1, 1), way(1, 1)]) == [0, 1]


def test_an_error_of_zero_is_best():
    assert front([way(1, 1), way(2, 0), way(3, 0.5)]) == [0, 1]


def test_what_noise_may_have_beaten_stays_near():
    best = way(1, 1, error_interval=(0.9, 1.1))
    close = way(2, 1.2, error_interval=(1.05, 1.35))
    far = way(2, 1.4, error_interval=(1.1, 1.7))
    assert standings([best, close, far]) == ["front", "near", "beaten"]


def test_spread_of_time_counts_too():
    best = way(1, 1, cost_interval=(0.8, 1.3))
    assert standings([best, way(1.2, 2, cost_interval=(1.1, 1.4))]) == ["front", "near"]


def test_an_unknown_interval_beats_nothing_for_sure():
    assert standings([way(1, 1, error_interval=UNKNOWN), way(2, 2)]) == ["front", "near"]
    assert standings([way(1, 1), way(2, 2, error_interval=UNKNOWN)]) == ["front", "near"]


def test_what_has_no_figure_stands_nowhere_and_beats_nobody():
    assert standings([way(1, math.nan), way(2, 2), way(math.nan, 0)]) == [None, "front", None]
    assert front([]) == []


figures = st.integers(0, 5)


@given(st.lists(st.tuples(figures, figures), max_size=12))
def test_each_way_is_on_the_front_or_beaten_by_one_that_is(pairs):
    ways = [way(*p) for p in pairs]
    best = front(ways)
    for i, candidate in enumerate(ways):
        assert (i in best) != any(ways[k].beats(candidate) for k in best)
