"""The pictures of the atlas: every cell where it belongs, and over its limit beyond mistaking."""

import math

import numpy as np
import pytest

from reports.html.stability.maps import map_views
from reports.html.stability.scale import (
    CELL,
    DEPARTURES,
    ERRORS,
    OVER,
    RATIOS,
    SHARES,
    WITHIN,
    place,
)
from reports.stability.results import Axis
from tests.reports.atlases import ALPHAS, COSINES, axes, furnace, made, small, worst
from tests.reports.pages import pixels

BLACK, WHITE = (0, 0, 0, 255), (255, 255, 255, 255)


def map_view(found):
    (view,) = map_views([found])
    return view


def cells(view, at=0):
    """A slice's pixels, (rows, columns, CELL, CELL, 4), the first row at the bottom as recorded."""
    image = pixels(view.slices[at].uri)
    rows, columns = image.shape[0] // CELL, image.shape[1] // CELL
    parted = image.reshape(rows, CELL, columns, CELL, 4).swapaxes(1, 2)
    return parted[::-1]


def colours(cell):
    """The colours of a cell, the most frequent first."""
    found, counts = np.unique(cell.reshape(-1, 4), axis=0, return_counts=True)
    return [tuple(int(c) for c in found[i]) for i in counts.argsort()[::-1]]


def rgba(colour):
    return (*(int(colour[i : i + 2], 16) for i in (1, 3, 5)), 255)


def is_orange(colour):
    return colour[0] > colour[2]


def test_a_cell_has_its_place_and_its_colour():
    view = map_view(small([[1e-9, 1e-6, 1.0], [1e-8, 1e-4, 50.0]], limit=None))
    found = cells(view)
    assert found.shape[:2] == (2, 3)
    assert colours(found[0, 0]) == [rgba(WITHIN[0])] == colours(found[1, 0])
    assert colours(found[0, 2]) == [rgba(WITHIN[-1])] == colours(found[1, 2])
    assert colours(found[1, 1]) == [rgba(WITHIN[2])]
    assert view.slices[0].cells == "1e−9;1e−6;1;1e−8;1e−4;50"


def test_larger_is_darker_below_and_above_the_limit():
    for limit in (None, 0.0):
        found = cells(map_view(small([[10.0**k for k in range(-8, 1)]], limit=limit)))
        light = [sum(max(colours(c), key=sum)[:3]) for c in found[0]]
        assert light == sorted(light, reverse=True) and len(set(light)) == 9


def test_what_is_over_its_limit_is_striped_where_it_is_judged_and_dotted_elsewhere():
    row = [1e-3, 1e-3, 1e-3, 1e-5]
    view = map_view(small([row], judged={"alpha": (ALPHAS[1], ALPHAS[3])}))
    outside, first, second, within = cells(view)[0]
    assert colours(first)[1] == BLACK and (first == second).all()
    assert np.count_nonzero((first == BLACK).all(axis=-1)) == 2 * CELL
    assert 4 <= np.count_nonzero((outside == BLACK).all(axis=-1)) <= 9
    assert colours(outside)[0] == colours(first)[0] and is_orange(colours(first)[0])
    assert not is_orange(colours(within)[0])
    assert len(colours(within)) == 1


def test_what_is_no_number_is_crossed_out_and_what_was_not_tried_is_clear():
    view = map_view(small([[math.nan, math.inf, None, 1e-6]], worst=worst(math.inf), passed=False))
    nan, infinite, nothing, fine = cells(view)[0]
    for cell in (nan, infinite):
        assert colours(cell) == [BLACK, WHITE]
    assert (nothing[..., 3] == 0).all() and (fine[..., 3] == 255).all()


def test_both_sides_of_a_range_are_over():
    fields = {"limit": 1.001, "passed": False, "worst": worst(0.9)}
    view = map_view(small([[0.9, 1.0, 1.2]], at_least=0.999, **fields))
    low, right, high = cells(view)[0]
    assert BLACK in colours(low) and BLACK in colours(high) and BLACK not in colours(right)
    assert view.slices[0].cells == "0.9;1;1.2" and view.limit == "1 ± 0.001"
    assert view.limits == [pytest.approx(62.5)]
    low, right, high = cells(map_view(small([[0.2, 1.0, 1.2]], at_least=0.0, **fields)))[0]
    assert BLACK not in colours(low) and BLACK not in colours(right) and BLACK in colours(high)


def test_scales_are_the_same_for_every_map():
    assert [place(ERRORS, v) for v in (0, 1e-8, 1e-4, 1, 7, math.inf)] == [0, 0, 50, 100, 100, 100]
    assert [place(DEPARTURES, v) for v in (1, 0.99, 1.01, 0, 5)] == [0, 75, 75, 100, 100]
    assert [place(SHARES, v) for v in (0, 1, 3)] == [0, 80, 100]


def test_shares_of_what_is_allowed_are_linear():
    view = map_view(small([[0.0, 0.625, 1.25]], limit=1.0, passed=False))
    assert view.ticks == RATIOS.ticks and view.limits == [80]
    none, half, most = cells(view)[0]
    assert colours(none) == [rgba(WITHIN[0])] and colours(half) == [rgba(WITHIN[2])]
    assert colours(most)[0] == rgba(OVER[-1])


def test_every_map_has_a_dot_by_how_far_off_its_worst_figure_is():
    share = {"at_least": 0.0, "limit": 1.001}
    dots = {
        (value, limit): (view.dot, view.bound)
        for value, limit, view in (
            (v, fields.get("limit"), map_view(small([[v]], worst=worst(v), **fields)))
            for v, fields in (
                (1 + 1e-5, share), (0.5, share), (1e-6, {"limit": 1e-4}), (math.nan, {}),
                (1 - 1e-6, {"at_least": 0.999, "limit": 1.001}), (1e-2, {"limit": None}),
            )
        )
    }  # fmt: skip
    bound = pytest.approx(62.5, abs=0.01)
    assert dots[1 + 1e-5, 1.001] == (pytest.approx(37.5, abs=0.01), bound)
    assert dots[0.5, 1.001] == (0, bound)
    assert dots[1e-6, 1e-4] == (25, 50)
    assert dots[1 - 1e-6, 1.001] == (pytest.approx(25, abs=0.01), bound)
    assert dots[1e-2, None] == (75, None)
    assert [d for (v, _), (d, _) in dots.items() if v != v] == [100]


def test_maps_of_one_invariant_share_a_scale():
    judged = made(at_least=0.999, limit=1.001)
    told, other = made(limit=None, masking="paper"), made("brdf", "reciprocal")
    views = map_views([judged, told, other])
    assert views[0].ticks == views[1].ticks == DEPARTURES.ticks and views[2].ticks == ERRORS.ticks
    shares = map_views([made(at_least=0.0, limit=1.001)])
    assert shares[0].ticks == SHARES.ticks
    assert shares[0].limits == [0, pytest.approx(80.08)]


def test_the_limit_is_marked_on_the_scale():
    view = map_view(made(limit=1e-4))
    assert view.limits == [50.0]
    blue, orange = view.legend.split(" 50%, ")[0], view.legend.split(" 50%, ")[1]
    assert rgb(WITHIN[0]) in blue and rgb(OVER[2]) in orange
    alone = map_view(made(limit=None))
    assert not alone.limits and rgb(WITHIN[-1]) in alone.legend


def rgb(colour):
    return f"rgb({' '.join(map(str, rgba(colour)[:3]))})"


def test_the_frame_holds_what_is_judged():
    view = map_view(made())
    left, top, width, height = view.box
    assert (left, top) == (pytest.approx(100 * 8 / 17, abs=0.01), 0)
    assert width == pytest.approx(100 * 9 / 17, abs=0.01)
    assert height == pytest.approx(100 * 9 / 13, abs=0.01)
    assert map_view(made(judged={}, beyond=None)).box is None
    assert map_view(made(limit=None)).box is None


def test_the_worst_point_is_marked_in_its_cell():
    view = map_view(made())
    marks = {m.kind: (s.label, m.x, m.y) for s in view.slices for m in s.marks}

    def column(k):
        return pytest.approx(100 * (k + 0.5) / len(ALPHAS), abs=0.01)

    def row(k):
        return pytest.approx(100 - 100 * (k + 0.5) / len(COSINES), abs=0.01)

    assert marks["worst"] == ("weight 1", column(8), row(4))
    assert marks["beyond"] == ("weight 1", column(0), row(0))
    lost = made(of=furnace, at_least=0.999, limit=1.001, judged={}, worst=worst(1 - 0.0031),
                beyond=None, passed=False)  # fmt: skip
    (mark,) = [(s.label, m.kind) for s in map_view(lost).slices for m in s.marks]
    assert mark == ("weight 0.5", "worst")


def test_the_worst_point_is_found_by_its_inputs_where_figures_are_alike():
    told = worst(1e-6, alpha="0.1", weight="0.25", wo="0.3,0.9,0.001")
    view = map_view(made(of=lambda *_: 1e-6, judged={}, beyond=None, worst=told))
    ((label, mark),) = [(s.label, m) for s in view.slices for m in s.marks]
    assert label == "weight 0.25"
    at = (100 * 12.5 / len(ALPHAS), 100 - 100 * 6.5 / len(COSINES))
    assert (mark.x, mark.y) == pytest.approx(at, abs=0.01)


def test_axes_are_labelled_with_whole_powers_of_ten():
    view = map_view(made())
    assert {t for _, t in view.columns} == {"1e−4", "0.01", "1"}
    assert {t for _, t in view.rows} == {"1e−6", "1e−4", "0.01", "1"}
    assert dict((t, at) for at, t in view.rows)["1"] < 10  # on top
    assert [s.label for s in view.slices][:2] == ["weight 0", "weight 1e−7"]


def test_slices_of_nothing_have_no_label():
    nameless = (Axis(name="", values=[0]), *axes([1.0], COSINES[:1], ALPHAS[:2])[1:])
    (shown,) = map_view(small([[1e-9, 1e-6]], axes=nameless)).slices
    assert shown.label == ""
