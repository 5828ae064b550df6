"""Earlier runs of a suite: remembered in order, and shown as a trend."""

import numpy as np

from reports.history import MOST, load_history, remember, trends
from tests.reports.pages import Page, results, row, written

KEY = ("spheres.dusk", "paper", "global")


def test_runs_are_remembered_with_the_worst_of_each_case(folder):
    for error in (0.1, 0.3):
        rows = [row(energy_local=error), row(object="right", energy_local=0.05)]
        remember(results(rows, created=f"2026-01-0{int(10 * error)}"), folder)
    assert trends(load_history(folder), "tiny")[KEY] == [("2026-01-01", 0.1), ("2026-01-03", 0.3)]
    assert trends(load_history(folder), "other") == {}


def test_what_could_not_be_measured_is_no_point_of_a_trend(folder):
    remember(results([row(energy_local=np.nan)]), folder)
    assert trends(load_history(folder), "tiny") == {} and len(load_history(folder)) == 1


def test_old_runs_make_room(folder):
    remember(results([row()]), folder)
    line = (folder / "history.jsonl").read_text()
    (folder / "history.jsonl").write_text(line * (MOST + 5))
    remember(results([row()], created="now"), folder)
    runs = load_history(folder)
    assert len(runs) == MOST and runs[-1].created == "now"


def test_a_case_shows_its_trend(folder):
    for error in (0.1, 0.2, 0.15):
        run = results([row(energy_local=error)])
        remember(run, folder)
    page = Page(written(run, folder))
    (line,) = [a for t, a in page.elements if t == "polyline"]
    heights = [float(p.split(",")[1]) for p in line["points"].split()]
    assert heights[0] > heights[2] > heights[1]  # the worst stands on top
    (told,) = [
        a["aria-label"] for t, a in page.elements if t == "svg" and "Trend" in a["aria-label"]
    ]
    assert "over 3 runs" in told


def test_one_run_is_no_trend(folder):
    run = results([row()])
    remember(run, folder)
    assert not [t for t, _ in Page(written(run, folder)).elements if t == "polyline"]


def test_a_damaged_history_is_told_and_costs_nothing_else(folder):
    (folder / "history.jsonl").write_text("{}\n")
    page = Page(written(results([row()]), folder))
    assert "No trends: " in page.text["p"] and "line 1" in page.text["p"]


def test_a_run_adds_itself(tiny):
    assert len(load_history(tiny)) == 1


def test_a_damaged_history_stops_a_run_before_it_begins(shadeproof, tmp_path):
    (tmp_path / "history.jsonl").write_text("garbage\n")
    code, _, err = shadeproof("compare", "--suite", "tiny", "--out", tmp_path)
    assert code == 2 and "history.jsonl: line 1" in err
    assert not (tmp_path / "frames").exists()
