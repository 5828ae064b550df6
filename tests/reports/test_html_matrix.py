"""The matrix of the report: each cell's largest error, and what is nearest its budget."""

import numpy as np
import pytest

from reports.gate import judge
from reports.html.figures import METRICS
from reports.html.matrix import cell, matrices
from tests.reports.pages import BUDGET, Page, results, row, written


@pytest.mark.parametrize(
    ("figures", "state", "undecided"),
    [
        ({"energy_local": 0.1, "energy_local_ci95": (0.09, 0.11)}, "within2", False),
        ({"energy_local": 0.21, "energy_local_ci95": (0.19, 0.23)}, "over1", True),
        ({"energy_local": 0.9, "energy_local_ci95": (0.8, 1.0)}, "over3", False),
        ({"energy_local": np.nan, "energy_local_ci95": (np.nan, np.nan)}, "broken", False),
        ({"truth": "unoccluded"}, "reported", False),
    ],
)
def test_cells_are_coloured_by_margin_and_hatched_by_noise(figures, state, undecided):
    made = cell(METRICS["energy_local"], row(**figures))
    assert (made.state, made.undecided) == (state, undecided)


def test_matrix_shows_the_worst_place_of_a_material(folder):
    far = row(case="spheres.noon", energy_local=0.19, energy_local_ci95=(0.185, 0.195))
    page = Page(written(results([row(), far]), folder))
    (label,) = [a["aria-label"] for t, a in page.elements
                if t == "a" and a.get("aria-label", "").startswith("copper")
                and "Local energy" in a["aria-label"]]  # fmt: skip
    assert "19.0" in label and "the largest error of 2 places" in label


def eased(**figures):
    """A row of another case, whose budget of local energy is .8."""
    loose = BUDGET.model_copy(update={"energy_local": 0.8, "reason": "a lamp"})
    return judge(row(case="spheres.noon", **figures), [loose])


def local_matrix(rows):
    made = next(m for m in matrices(rows) if m.metric == "energy_local")
    (line,) = made.lines
    (found,) = line.cells
    return found


def test_matrix_shows_the_largest_error_and_what_is_closest_to_its_budget(folder):
    near = row(energy_local=0.19, energy_local_ci95=(0.185, 0.195))
    far = eased(energy_local=0.5, energy_local_ci95=(0.49, 0.51))
    found = local_matrix([near, far])
    told = "19.0\u202f% of 20\u202f%"
    assert (found.text, found.limit) == ("50.0\u202f%", "≤\u202f80\u202f%")
    assert (found.place, found.nearest) == ("spheres.noon", told)
    assert found.href == "#row--spheres.noon--left--paper--global" and told in found.label
    assert told in Page(written(results([near, far]), folder)).text["table"]


def test_matrix_has_the_colour_of_what_is_closest_to_its_budget():
    over = row(energy_local=0.25, energy_local_ci95=(0.24, 0.26))
    far = eased(energy_local=0.5, energy_local_ci95=(0.49, 0.51))
    found = local_matrix([over, far])
    assert found.text == "50.0\u202f%" and found.state == "over1"
    lost = eased(energy_local=np.nan, energy_local_ci95=(np.nan, np.nan))
    assert local_matrix([over, lost]).state == "broken"


def test_matrix_says_one_figure_where_the_largest_is_closest_to_its_budget():
    found = local_matrix([row(), eased(energy_local=0.7, energy_local_ci95=(0.69, 0.71))])
    assert found.place == "spheres.noon" and not found.nearest
    alone = local_matrix([row()])
    assert not alone.place and not alone.nearest
    twins = local_matrix([row(), row(object="right", energy_local=0.15)])
    assert twins.place == "spheres.dusk, right"


@pytest.mark.parametrize(
    ("figures", "name"),
    [({"ssim": 0.99}, "local"), ({"energy_error": 0.9, "energy_ci95": (0.8, 1.0)}, "total")],
)
def test_matrix_starts_with_what_the_headline_names(folder, figures, name):
    budget = BUDGET.model_copy(update={"energy_error": 0.5})
    page = Page(written(results([judge(row(**figures), [budget])]), folder))
    assert f"{name} energy" in page.text["h1"]
    (chosen,) = [a["value"] for t, a in page.elements
                 if t == "input" and a.get("data-axis") == "energy" and "checked" in a]  # fmt: skip
    shown = {a["data-energy"] for t, a in page.elements
             if "data-energy" in a and "hidden" not in a}  # fmt: skip
    assert chosen == name and shown == {name, ""}


@pytest.mark.parametrize(
    ("batches", "why"), [(8, "the reference's noise hides it"), (1, "one batch has no spread")]
)
def test_an_interval_that_noise_hides_is_told(folder, batches, why):
    hidden = row(ssim_ci95=(np.nan, np.nan), reference_batches=batches)
    made = cell(METRICS["ssim"], hidden)
    words = f"±\u202funknown: {why}"
    assert words in made.label and made.undecided and made.spread == "±\u202funknown"
    page = Page(written(results([hidden]), folder))
    assert words in page.text["table"]
    assert "noise hides whether" in page.text["h1"] and "SSIM budget" in page.text["h1"]


def mixed(weights, **fields):
    """A row for each weight, of a material of its own."""
    return [row(object=f"m{i}", material=f"m{i}", weight=w, **fields)
            for i, w in enumerate(weights)]  # fmt: skip


def test_objects_of_one_weight_each_are_a_list(folder):
    rows = mixed([0, 0.2, 0.5, 0.7])
    made = matrices(rows)[0]
    assert not made.weights
    assert [(x.material, x.weight, len(x.cells)) for x in made.lines] == [
        ("m0", "0", 1), ("m1", "0.2", 1), ("m2", "0.5", 1), ("m3", "0.7", 1),
    ]  # fmt: skip
    page = Page(written(results(rows), folder))
    tables = [a["class"] for t, a in page.elements if t == "table" and "matrix" in a["class"]]
    assert set(tables) == {"matrix listed"}
    assert not any(a.get("class") == "empty" for _, a in page.elements)


def test_each_technique_has_the_weights_that_it_was_tried_with():
    both = [row(weight=w, technique="sampled") for w in (0.4, 0.45)]
    made = {m.technique: m for m in matrices(mixed([0, 0.2, 0.5, 0.7]) + both)}
    assert made["sampled"].weights == ["0.4", "0.45"] and not made["paper"].weights
    assert [x.material for x in made["sampled"].lines] == ["copper"]


def test_a_grid_that_is_mostly_full_stays_one():
    rows = [row(material=m, object=m, weight=w) for m in "ab" for w in (0, 0.5, 1)][:-1]
    made = matrices(rows)[0]
    assert made.weights == ["0", "0.5", "1"]
    assert [None in x.cells for x in made.lines] == [False, True]
