"""stability.html and its section in report.html: whole, offline, and true to the record."""

import math
import re

import pytest

from reports.html.numbers import departure, figure, input_value, prose
from reports.html.stability import stability_of, write_page
from reports.html.stability.view import headline, stability_view
from reports.stability.promise import HARD_HOLDS
from reports.stability.results import Promise, Stability, load_stability, save_stability
from tests.reports.atlases import (
    EVIL,
    broken,
    full_stability,
    hard,
    made,
    promise,
    worst,
)
from tests.reports.pages import Page, bare_report, shown_text


def page_of(folder, found):
    return Page(write_page(found, folder).read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("stability")


@pytest.fixture(scope="module")
def page(folder):
    return page_of(folder, full_stability())


def test_asks_for_nothing_and_every_link_leads_somewhere(page):
    for _, a in page.elements:
        assert a.get("href", "#").startswith(("#", "data:"))
        assert a.get("src", "data:").startswith("data:")
    ids = [a["id"] for _, a in page.elements if "id" in a]
    assert len(ids) == len(set(ids))
    assert {a["href"][1:] for t, a in page.elements if t == "a"} <= set(ids)
    assert {a["data-copy"] for _, a in page.elements if "data-copy" in a} <= set(ids)
    assert all("scope" in a for t, a in page.elements if t == "th")


def test_hostile_names_stay_text(page):
    assert not any("onclick" in a for _, a in page.elements)
    assert f"finite {EVIL}" in shown_text(page) and f"NaN {EVIL}" in shown_text(page)
    assert ".venv/bin/shadeproof stability <all>" in page.text["code"]


def test_what_is_missed_is_the_headline(page):
    assert page.text["h1"] == (
        "The shaders break a promise: 2 of 7 limits missed, 1 of 6 hard cases broken, "
        f"1 of 2 promises not kept; the worst is sample_ggx, finite {EVIL}: ∞ where 0 is allowed"
    )
    assert [a["class"] for t, a in page.elements if t == "h1"] == ["verdict fail"]


def test_a_headline_tells_what_holds():
    fine = full_stability(maps=[made()], hard=[hard(), hard("b")], domain=[promise()])
    assert headline(fine) == "The shaders keep every promise: 1 limit and 2 hard cases hold"
    lost = full_stability(maps=[made()], hard=[], domain=[promise(held=False)])
    assert headline(lost) == "The shaders break a promise: 1 of 1 promise not kept"


def test_a_promise_about_all_hard_cases_counts_them():
    held = Promise(claim=HARD_HOLDS, bounds={}, limit=0.0, worst=1.0, held=False)
    broken = full_stability(maps=[made()], hard=[hard(), hard("b", passed=False)], domain=[held])
    assert [p.told for p in stability_view(broken).promises] == ["1 of 2"]


def test_the_domain_stands_on_top_with_what_is_not_kept_first(page):
    words = shown_text(page)
    first = words.index("not kept: D, G, F and the whole BRDF agree with double precision")
    assert first < words.index(" kept: D, G, F", first + 12) < words.index("Every function")
    assert "alpha 0.01 to 1, n·v 1e−4 to 1; worst 0.0031, 1e−4 allowed" in words


def test_the_summary_is_worst_first_with_the_unlimited_last():
    view = stability_view(full_stability())
    found = [(m.map.function, m.worst, m.limit) for m in view.summary]
    assert found[:2] == [("sample_ggx", "∞", "0"), ("G_smith_mixture", "1 − 0.0031", "1 ± 0.001")]
    assert found[-1] == ("brdf", "0.02", "")
    assert found[2:6] == [
        ("D_ggx", "1.6e−6", "≤ 1e−4"), ("brdf", "1.6e−6", "≤ 1e−4"),
        ("brdf", "1.6e−6", "≤ 1e−4"), ("D_beckmann", "5.32e−8", "≤ 1e−4"),
    ]  # fmt: skip


def unfolded(page):
    """The functions and the maps of the atlas that are."""
    folds = [a for t, a in page.elements if t == "details" and "fold" in a.get("class", "")]
    functions = [a["id"] for a in folds if "function" in a["class"] and "open" in a]
    return functions, sum("map" in a["class"] and "open" in a for a in folds)


def test_what_misses_a_limit_is_unfolded_and_one_map_in_any_case(page, tmp_path):
    assert unfolded(page) == (
        ["atlas--sample_ggx", "atlas--G_smith_mixture", "atlas--brdf"], 3,
    )  # fmt: skip
    fine = [made("D_ggx"), made("brdf", "reciprocal", limit=2e-5), made(), made(masking="smith")]
    view = stability_view(full_stability(maps=fine))
    assert [f.name for f in view.functions] == ["brdf", "D_ggx"]
    assert view.functions[0].maps[0].map.invariant == "against float64"
    assert unfolded(page_of(tmp_path, full_stability(maps=fine))) == (["atlas--brdf"], 1)


def test_a_share_of_light_ranks_by_what_is_over_1():
    def share(name, value):
        allowed = {"at_least": 0.0, "limit": 1.001, "judged": {}, "beyond": None}
        return made(name, of=lambda *_: value, worst=worst(value), passed=True, **allowed)

    maps = [share("far", 1 + 2.4e-5), share("none", 0.7), made("near"), share("close", 1.0009)]
    found = [m.map.function for m in stability_view(full_stability(maps=maps)).summary]
    assert found == ["close", "far", "near", "none"]


def test_a_worst_point_has_its_inputs_and_its_command(page):
    words = shown_text(page)
    assert "Worst: 1.6e−6 alpha 0.01, wi 0,0.6,0.8" in words
    assert ".venv/bin/shadeproof stability --at 'brdf alpha=0.01 wi=0,0.6,0.8'" in words
    assert "Worst outside of it: 0.00634 alpha 0.0001" in words


def test_hard_cases_are_grouped_with_what_broke_first(page, tmp_path):
    words = shown_text(page)
    order = [words.index(f"{k} ") for k in ("Functions", "Materials", "Environments", "Meshes")]
    assert order == sorted(order) and "0 of 1 hold" in words and "NaN pixels 12" in words
    assert "h has no direction there." in words
    cases = [hard("fine"), hard("bad", passed=False)]
    ((_, told, own),) = stability_view(full_stability(hard=cases)).kinds
    assert told == "1 of 2 hold" and [c.case.name for c in own] == ["bad", "fine"]


def test_a_run_without_anything_is_a_page(tmp_path):
    bare = page_of(tmp_path, full_stability(maps=[], hard=[], domain=[]))
    assert bare.text["h1"] == "Nothing was tried"
    assert "Atlas" not in shown_text(bare) and "Hard cases" not in shown_text(bare)


def test_what_is_no_number_survives_the_record_and_is_told(tmp_path):
    maps = [made(of=broken, limit=0.0, judged={}, worst=worst(math.nan), passed=False)]
    save_stability(full_stability(maps=maps), tmp_path / "stability.json")
    read = load_stability(tmp_path / "stability.json")
    (view,) = stability_view(read).summary
    assert view.worst == "NaN" and view.slices[0].cells.split(";")[0] == "NaN"
    assert "NaN where 0 is allowed" in headline(read)
    assert view.slices[-1].cells.startswith("∞;") and view.slices[0].cells.endswith(";")


def test_a_damaged_record_is_told_in_the_report_in_a_line(tmp_path):
    assert stability_of(tmp_path) is None
    assert "The shaders on hard inputs" not in shown_text(bare_report(tmp_path))
    (tmp_path / "stability.json").write_text('{"schema_version": 7}')
    assert "is no stability.json of schema 1" in shown_text(bare_report(tmp_path))


def test_the_report_shows_the_record_that_lies_beside_it(tmp_path):
    save_stability(full_stability(), tmp_path / "stability.json")
    shown = bare_report(tmp_path)
    ids = [a["id"] for _, a in shown.elements if "id" in a]
    assert len(ids) == len(set(ids)) and {"stability", "atlas", "hard-cases"} <= set(ids)
    assert "The shaders break a promise" in shown_text(shown)
    assert "shaders on hard inputs: a promise is broken" in shown.text["header"]
    assert "#stability" in [a["href"] for tag, a in shown.elements if tag == "a"]


def test_same_record_makes_the_same_bytes(folder, page):
    path = write_page(full_stability(), folder)
    before = path.read_bytes()
    assert write_page(full_stability(), folder).read_bytes() == before
    assert not re.search(rb"https?:|@import|url\(|fetch\(", before)


def test_sixty_maps_are_under_three_megabytes(tmp_path):
    maps = [made("brdf", f"invariant {i}") for i in range(60)]
    found = Stability.model_validate_json(full_stability(maps=maps).model_dump_json())
    assert write_page(found, tmp_path).stat().st_size < 3e6


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"), (3.14e-6, "3.1e−6"), (1e-4, "1e−4"), (0.0031, "0.0031"), (0.025, "0.025"),
        (-2e-9, "−2e−9"), (12.0, "12"), (1e6, "1e6"), (None, "–"), (math.inf, "∞"),
        (-math.inf, "−∞"), (math.nan, "NaN"),
    ],
)  # fmt: skip
def test_figures_keep_their_power_of_ten(value, text):
    assert figure(value) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(1 - 1e-7, "1 − 1e−7"), (1.0, "1"), (0.25, "0.25"), (1e-7, "1e−7"), (0.0316, "0.0316")],
)
def test_inputs_just_below_1_are_told_apart_from_it(value, text):
    assert input_value(value) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(1 - 2.1e-5, "1 − 2.1e−5"), (1.0012, "1 + 0.0012"), (1.0, "1"), (0.4567, "0.457"), (0.0, "0")],
)
def test_what_is_about_1_is_told_by_its_departure(value, text):
    assert departure(value) == text


def test_figures_in_a_sentence_read_as_elsewhere():
    said = "off by 2.1e+00 at worst (alpha 1e-4, 7.6e-01 of -1.0e-06; allowed 1e-04)"
    assert prose(said) == "off by 2.1 at worst (alpha 1e-4, 0.76 of −1e−6; allowed 1e−4)"
    assert prose("code 0a7e-01, 12e+05") == "code 0a7e-01, 12e+05"
