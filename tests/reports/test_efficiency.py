"""Time to an interval: what fewer samples and fewer seconds are worth."""

import math
from dataclasses import replace

import pytest
from rich.console import Console

from reports.efficiency import Efficiency, bootstrapped, median, print_efficiencies

ONE = Efficiency("case", "thing", "global", "ssim", 0.01, 0.02, 10.0, 5.0, 20.0)


def test_half_the_error_is_worth_four_times_the_samples():
    assert ONE.gain == pytest.approx(4 * 20 / 10)
    assert ONE.alone == pytest.approx(4 * 5 / 10)
    assert replace(ONE, seconds=20.0).gain == pytest.approx(4)


def test_what_noise_hides_is_counted_and_gains_nothing(capsys):
    hidden = replace(ONE, plain_se=math.nan, figure="energy_error")
    assert math.isnan(hidden.gain)
    assert median([ONE.gain, hidden.gain]) == ONE.gain
    others = [replace(ONE, figure="energy_local"), hidden]
    print_efficiencies([ONE, *others], Console(width=200))
    said = capsys.readouterr().out
    assert "left out: 1 figures" in said
    assert "if `global` were all that is wanted: 2.00" in said


def test_the_median_has_bounds_from_the_objects():
    found = [replace(ONE, object=str(k), se=0.01 * (1 + k / 10)) for k in range(20)]
    low, high = bootstrapped(found)
    assert low < median(e.gain for e in found) < high
