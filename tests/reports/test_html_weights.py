"""Error over the mixture weight, as the report draws it."""

import numpy as np

from reports.html.weights import weight_charts
from tests.reports.pages import Page, results, row, written


def over(*weights, **fields):
    """Rows of one material at some weights, an object each, errors as large as the weight."""
    return [
        row(object=f"o{w}", weight=w, weight_g=w, energy_local=0.1 + w / 10, **fields)
        for w in weights
    ]


def test_a_material_at_three_weights_gets_a_chart_of_each_figure_for_each_truth():
    rows = over(0.0, 0.5, 1.0) + over(0.0, 0.5, 1.0, technique="best")
    rows += over(0.0, 0.5, 1.0, truth="direct") + over(0.0, 1.0, material="gold")
    found = weight_charts(rows)
    assert [w.truth for w in found] == ["direct", "direct", "global", "global"]
    local = found[2].chart
    assert local.title == "copper, spheres in dusk"
    assert local.header == ["weight (share of GGX)", "paper", "best"]
    assert [line[0] for line in local.rows] == ["0", "0.5", "1"]
    assert [line[1][:2] for line in local.rows] == ["10", "15", "20"]


def test_weights_of_different_cases_of_a_scene_make_one_curve():
    rows = [r.model_copy(update={"case": f"spheres.dusk.{r.weight}"}) for r in over(0, 0.5, 1)]
    (local, _) = weight_charts(rows)
    assert len(local.chart.rows) == 3


def test_of_several_objects_of_a_weight_the_worst_is_drawn():
    rows = [*over(0.0, 0.5, 1.0), row(weight=0.5, weight_g=0.5, energy_local=0.6, ssim=0.2)]
    local, ssim = (w.chart for w in weight_charts(rows))
    assert local.rows[1][1].startswith("60") and ssim.rows[1][1] == "0.2000"


def test_masking_of_its_own_weight_is_another_curve():
    rows = over(0.0, 0.5, 1.0)
    rows += [r.model_copy(update={"weight_g": 1.0}) for r in over(0.0, 0.5)]
    assert len(weight_charts(rows)) == 2


def test_more_techniques_than_colours_take_more_charts():
    rows = [r for k in range(5) for r in over(0.0, 0.5, 1.0, technique=f"t{k}")]
    assert [len(w.chart.header) - 1 for w in weight_charts(rows)] == [4, 4, 1, 1]


def test_what_was_not_measured_leaves_a_gap_and_two_weights_no_chart(folder):
    rows = over(0.0, 0.5, 1.0)
    rows[1] = rows[1].model_copy(update={"ssim": np.nan, "energy_local": np.nan})
    local, _ = (w.chart for w in weight_charts(rows))
    assert local.rows[1][1] == "–"
    assert not weight_charts(over(0.0, 1.0))
    page = Page(written(results(over(0.0, 0.5, 1.0)), folder))
    assert "Error over the mixture weight" in page.text["h2"]
