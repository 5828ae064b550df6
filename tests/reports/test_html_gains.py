"""What each technique gains and costs, as the report tells it."""

import numpy as np

from reports.html.gains import gains_of
from tests.reports.pages import Page, results, row, written


def drawn(technique, ssim, frame_ms, **figures):
    return row(technique=technique, ssim=ssim, frame_ms=frame_ms, **figures)


def test_medians_are_of_what_all_techniques_drew_and_times_case_by_case():
    two = [{"case": "a.noon"}, {"case": "b.noon"}]
    rows = [drawn("paper", 0.8, 10.0, **c) for c in two]
    rows += [drawn("best", s, ms, **c) for s, ms, c in zip((0.9, 0.98), (20, 40), two, strict=True)]
    rows += [drawn("best", 0.1, 1.0, case="c.noon")]  # which paper did not draw
    rows.append(drawn("best", 0.2, 1.0, truth="unoccluded", **two[0]))
    found = gains_of(rows)
    paper, best = found.lines
    assert (found.truth, found.objects) == ("global", 2)
    assert (best.technique, best.ssim, best.worst_ssim) == ("best", "0.9400", "0.9000")
    assert (float(paper.times), float(best.times)) == (1.0, 3.0)


def test_nothing_is_told_of_one_technique_or_of_nothing_in_common():
    assert gains_of([]) is None
    assert gains_of([drawn("paper", 0.8, 10.0)]) is None
    assert gains_of([drawn("paper", 0.8, 1.0), drawn("best", 0.9, 1.0, case="x.noon")]) is None


def test_a_figure_that_is_not_known_is_a_dash(folder):
    rows = [drawn("paper", np.nan, 10.0), drawn("best", 0.9, np.nan)]
    found = gains_of(rows)
    assert found.lines[0].ssim == found.lines[1].frame == "–"
    assert "What each technique gains and costs" in Page(written(results(rows), folder)).text["h2"]
