"""What a bench prints."""

import math

from rich.console import Console

from reports.run.bench.measured import timed
from reports.speed.points import Bench, Point
from reports.speed.table import print_bench
from tests.reports import benches


def test_the_ratio_at_full_size_is_told(capsys):
    points = [
        Point(
            case="c", environment="e", width=1920, height=1080, family=kind, name=name,
            samples=samples, frame=timed([seconds] * 3),
        )
        for kind, name, samples, seconds in (
            ("real-time", "paper", 0, 0.1),
            ("path traced", "Mitsuba 1", 1, 0.4),
        )
    ]  # fmt: skip
    bench = Bench(
        suite="s", suite_path="s.toml", command="", created="", seconds=1, provenance={},
        points=points,
    )  # fmt: skip
    print_bench(bench, Console(width=160))
    assert "1920x1080 ratio to Mitsuba 1 sample, c: paper 0.250" in capsys.readouterr().out


def test_the_tables_tell_apart_cases_with_long_names_and_leave_out_unknown_errors(capsys):
    names = [f"single.courtyard.copper.weight=0.{n}.roughness=0.5" for n in (25, 75)]
    errors = [benches.error("seen", 0.1, 0.2), benches.error("away", math.nan, math.nan)]
    points = [benches.point(case=n, errors=errors) for n in names]
    points += [benches.point(case=n, name="paper-noaa", errors=errors[1:]) for n in names]
    needs = [benches.equal(case=n, object="seen") for n in names]
    print_bench(benches.small_bench(points=points, equal=needs), Console(width=160))
    told = "".join(capsys.readouterr().out.split())
    assert all(told.count(n) == 2 for n in names), "each in both tables"
    assert "10.00%0.2000" in told and told.count("unknownunknown") == 2 and "nan%" not in told
