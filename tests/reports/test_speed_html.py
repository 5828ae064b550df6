"""bench.html and its section in report.html: whole, offline, and true to the record."""

import math
import re

import pytest

from reports.html.figures import digits, seconds, size
from reports.html.logaxis import LogAxis
from reports.html.speed import speed_of, write_page
from reports.html.speed.labels import Label, places
from reports.html.speed.scatter import MODES, plots
from reports.html.speed.view import speed_view
from reports.html.speed.words import growth, headline, paper_rate, verdict_of
from reports.results import Figured
from reports.speed.points import LeftOut, save_bench
from tests.reports.benches import (
    EVIL,
    NAN,
    bunnies,
    crowd,
    equal,
    error,
    full_bench,
    grown,
    lonely,
    point,
    small_bench,
)
from tests.reports.pages import Page, bare_report, plain, shown_text


def of(page, tag, **wanted):
    """The attributes of the elements that have those wanted."""
    return [a for t, a in page.elements if t == tag and wanted.items() <= a.items()]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("bench")


@pytest.fixture(scope="module")
def text(folder):
    return write_page(full_bench(), folder).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def page(text):
    return Page(text)


def test_asks_for_nothing_outside_the_page(text, page):
    assert not re.search(r"https?:|//\w|@import|url\(|fetch\(|XMLHttp|import\(", text)
    assert (
        "default-src 'none'"
        in of(page, "meta", **{"http-equiv": "Content-Security-Policy"})[0]["content"]
    )


def test_ids_are_unique_and_every_link_leads_somewhere(page):
    ids = [a["id"] for _, a in page.elements if "id" in a]
    assert len(ids) == len(set(ids))
    assert {a["href"][1:] for a in of(page, "a")} <= set(ids)


def test_hostile_names_stay_text(page):
    assert not any("onclick" in a for _, a in page.elements)
    assert (
        EVIL in shown_text(page)
        and "lonely <i>" in shown_text(page)
        and "ball & <cone>" in shown_text(page)
    )
    assert ".venv/bin/shadeproof bench <all>" in shown_text(page)


def test_no_figure_reads_nan(page):
    assert not re.search(r"\b(nan|inf|None)\b", shown_text(page))


def test_same_bench_makes_the_same_bytes(folder, text):
    assert write_page(full_bench(), folder).read_text(encoding="utf-8") == text


def test_every_point_with_figures_is_on_its_plots(page):
    spots = of(page, "li")
    drawn = [a for a in spots if "data-moves" in a]
    assert len(drawn) == 2 * 3 * len(bunnies()) + 1 + 2 * 60
    families = {a["class"] for a in drawn}
    assert families == {"real-time", "path-traced", "denoised"}


def test_sections_without_content_are_left_out(tmp_path, page):
    headings = ("How cost grows", "Sampling a mixture", "does without", "Left out:")
    bare = Page(write_page(small_bench(points=lonely()), tmp_path).read_text(encoding="utf-8"))
    for heading in headings:
        assert heading in shown_text(page) and heading not in shown_text(bare)


def test_a_bench_without_points_is_a_page(tmp_path):
    shown = Page(write_page(small_bench(points=[]), tmp_path).read_text(encoding="utf-8"))
    assert "Speed against error in 0 cases" in shown_text(shown)


def test_a_damaged_bench_is_told_and_not_fatal(tmp_path):
    assert speed_of(tmp_path) is None
    (tmp_path / "bench.json").write_text("{")
    assert "is no bench.json of schema" in speed_of(tmp_path)
    save_bench(small_bench(points=lonely()), tmp_path / "bench.json")
    assert speed_of(tmp_path).cases[0].name == "lonely <i>"


def test_the_report_shows_the_bench_that_lies_beside_it(tmp_path):
    assert "Speed against error" not in shown_text(bare_report(tmp_path))
    save_bench(small_bench(points=bunnies()), tmp_path / "bench.json")
    shown = bare_report(tmp_path)
    ids = [a["id"] for _, a in shown.elements if "id" in a]
    assert len(ids) == len(set(ids)) and "speed" in ids
    assert "No technique reaches 60 frames per second" in shown_text(shown)
    assert len([a for a in of(shown, "li") if "data-moves" in a]) == 6 * len(bunnies())


def test_the_report_stands_where_its_bench_is_damaged(tmp_path):
    (tmp_path / "bench.json").write_text('{"schema_version": 7}')
    assert "is no bench.json of schema 1" in shown_text(bare_report(tmp_path))


def local(points, name="copper", modes=MODES):
    return plots(points, name, modes)[0]


def test_points_lie_where_their_figures_are():
    """On axes of 10 ms to 10 s and of 1 % to 100 %."""
    points = [
        point(median=0.1, errors=[error("copper", 0.1, 0.1, 0)]),
        point(name="slow", median=1, errors=[error("copper", 0.02, 0.1, 0)], after={"light": 8.0}),
        point(name="fast", median=0.012, errors=[error("copper", 0.8, 0.1, 0)], after={}),
    ]
    plot = local(points)
    at = {s.point.name: (s.states["warm"].x, s.y) for s in plot.spots}
    assert at["paper"] == pytest.approx((100 / 3, 50), abs=0.01)
    assert at["slow"] == pytest.approx((200 / 3, 100 - 50 * math.log10(2)), abs=0.01)


def test_time_means_what_the_switch_says():
    """Made once: .02 + .4 + .05 s."""
    plot = local(bunnies())
    (paper,) = [s for s in plot.spots if s.point.name == "paper"]
    told = {mode: plain(state.time) for mode, state in paper.states.items()}
    assert told["warm"] == "65 ms (62.4 ms to 70.2 ms)"
    assert told["over 1"] == "535 ms (532 ms to 540 ms)"
    assert told["over 60"].startswith("72.8 ms")
    assert told["over 10,000"].startswith("65 ms")
    assert told["new light"] == "500 ms" and told["new geometry"] == "130 ms"
    assert list(told) == [m.name for m in MODES]
    xs = {mode: state.x for mode, state in paper.states.items()}
    assert xs["warm"] < xs["over 60"] < xs["new light"] < xs["over 1"]


def test_a_time_whose_spread_is_unknown_beats_nothing_for_sure():
    points = [
        point(name=name, median=seconds, errors=[error("copper", seconds, 0.1)], after={"light": t})
        for name, seconds, t in (("better", 0.1, 1.0), ("worse", 0.9, 1.1))
    ]
    stands = {s.point.name: s.states for s in local(points).spots}
    assert stands["worse"]["warm"].standing == "beaten"
    assert stands["worse"]["new light"].standing == "near"
    assert stands["worse"]["new light"].low == stands["worse"]["new light"].x


def test_a_point_has_no_place_where_its_time_is_unknown():
    (spot,) = local(lonely(), "ball & <cone>").spots
    assert list(spot.states) == ["warm"]


def test_no_error_at_all_lies_on_the_lower_edge_and_says_so(page):
    (spot,) = local(lonely(), "ball & <cone>").spots
    assert spot.off and spot.y == 100 and (spot.top, spot.bottom) == (100, 100)
    assert f"{EVIL}, 0" in shown_text(page)


def test_the_front_is_a_stair_over_the_best_and_differs_by_mode():
    points = [
        point(name="quick", median=0.01, precomputation=5, errors=[error("copper", 0.1, 0.1)]),
        point(name="plain", median=0.1, precomputation=0, errors=[error("copper", 0.2, 0.1)]),
        point(name="right", median=1, precomputation=0, errors=[error("copper", 0.05, 0.1)]),
    ]
    plot = local(points)
    spots = {s.point.name: s for s in plot.spots}
    (front,) = [p for p in plot.paths if p.kind == "front"]
    quick, right = spots["quick"], spots["right"]
    assert front.d["warm"] == (
        f"M{quick.states['warm'].x:g} 0V{quick.y:g}H{right.states['warm'].x:g}V{right.y:g}H100"
    )
    assert spots["plain"].states["warm"].standing == "beaten"
    once = {n: s.states["over 1"].standing for n, s in spots.items()}
    assert once == {"quick": "beaten", "plain": "front", "right": "front"}


def test_lines_join_a_family_in_order_of_samples():
    (joined,) = [p for p in local(list(reversed(bunnies()))).paths if p.kind == "path traced"]
    xs = [float(x) for x, _ in re.findall(r"([\d.]+) ([\d.]+)", joined.d["warm"])]
    assert len(xs) == 5 and xs == sorted(xs) and joined.d["warm"].count("M") == 1


def test_two_sampled_techniques_are_two_lines():
    both = [
        point(name=f"{name}@{n}", samples=n, median=n / 10, errors=[error("copper", 0.1, 0.1)])
        for name in ("sampled", "other") for n in (1, 4)
    ]  # fmt: skip
    (joined,) = [p for p in local(both).paths if p.kind == "real-time"]
    assert joined.d["warm"].count("M") == 2


@pytest.mark.parametrize(("values", "ends"), [
    ([0.021, 4.2], (0.01, 5)), ([0.3], (0.05, 1)), ([0, -1, NAN], (0.2, 5)), ([1, 1e3], (0.5, 2e3)),
])  # fmt: skip
def test_axes_have_round_ends_around_what_they_show(values, ends):
    axis = LogAxis.around(values)
    assert (axis.low, axis.high) == ends
    assert axis.at(0) == 0 and axis.at(axis.low) == 0 and axis.at(1e9) == 100


def test_axes_have_few_ticks():
    assert LogAxis(0.01, 1).ticks() == [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1]
    assert LogAxis(0.02, 20).ticks() == [0.1, 1, 10]
    for decades in range(1, 12):
        assert 2 <= len(LogAxis(1e-3, 10 ** (decades - 3)).ticks()) <= 7


def test_labels_lie_on_no_other_label_or_mark():
    crowded = [Label(x, 50, "technique", "front") for x in (40, 42, 44, 46, 48, 50)]
    chosen = places(crowded)
    assert 0 < sum(map(bool, chosen)) < 6
    assert places(crowded[:1]) == ["below-left"]
    assert places([Label(0, 100, "technique", "front")]) == ["above-right"]
    rivals = [Label(50, 50, "beaten", "beaten"), Label(50, 50, "front", "front")]
    assert places(rivals)[1] == "below-left"


def told(*found, quantity=0):
    paper = bunnies()[0]
    plot = plots(bunnies(), "copper", MODES)[quantity]
    return plain(verdict_of(paper, "copper", plot.quantity, small_bench(equal=found)))


@pytest.mark.parametrize(
    ("found", "ending"),
    [
        ([], "65 ms a warm frame, local energy error 41.0 %."),
        (
            [equal()],
            "41.0 %. Mitsuba needs 3.2 samples (2.88 to 3.52) to be as good: 800 ms, "
            "12.3 times as long (11.1 to 13.5).",
        ),
        (
            [equal(samples=1, took=0.013, ratio=0.2)],
            "Mitsuba needs 1 sample (0.9 to 1.1) to be as good: 13 ms, 20.0 % of the time (18 to "
            "22).",
        ),
        (
            [equal("denoised", NAN, NAN, NAN, "above")],
            "Mitsuba with a denoiser does not get as good with the samples that were measured.",
        ),
        (
            [equal("denoised", NAN, NAN, NAN, "below"), equal(ratio=NAN)],
            "to be as good: 800 ms; Mitsuba with a denoiser is better at once, with 1 sample: "
            "870 ms, 13.4 times as long.",
        ),
        (
            [equal(samples=300, ratio=NAN, took=NAN, beyond="above")],
            "Mitsuba needs 300 samples (270 to 330), more than were measured, to be as good.",
        ),
        (
            [equal(samples=NAN, took=NAN, ratio=NAN)],
            "Noise hides how many samples Mitsuba would need.",
        ),
        (
            [equal(object="silver"), equal(case="x"), equal(figure="one_minus_ssim"),
             equal(technique="x")],
            "65 ms a warm frame, local energy error 41.0 %.",
        ),
    ],
)  # fmt: skip
def test_sentences_tell_what_path_tracing_needs(found, ending):
    assert told(*found).endswith(ending)


@pytest.mark.parametrize("end", [NAN, math.inf])
def test_an_interval_without_an_upper_end_says_or_more(end):
    open_ended = Figured(value=12, low=9, high=end)
    assert "12 samples (9 or more) to be" in told(
        equal().model_copy(update={"samples": open_ended})
    )


def test_each_figure_has_its_own_sentence():
    assert told(equal()) != told(equal(), quantity=1)
    assert told(equal(figure="one_minus_ssim"), quantity=1).startswith(
        "65 ms a warm frame, 1 − SSIM 0.1600. Mitsuba needs"
    )


def test_headline_tells_of_the_papers_frame_rate():
    assert plain(headline(small_bench())) == (
        "No technique reaches 60 frames per second at 1920×1080 on llvmpipe (LLVM 15.0.6, "
        "256 bits): the fastest, paper-noaa, takes 21 ms a frame"
    )
    fast = point(name="fast", median=0.015)  # its slow quartile: 16.2 ms
    assert headline(small_bench(points=[fast, *bunnies()])).startswith("fast reaches 60 frames")
    slow = point("other", name="fast", median=0.0166)  # 17.9 ms in another case
    reached = headline(small_bench(points=[fast, slow]))
    assert reached.startswith("No technique reaches")
    assert headline(small_bench(points=crowd())).startswith("Speed against error in 1 case on")
    assert paper_rate(small_bench(points=crowd())) == ""
    assert "paper-noaa 47.6, sampled@1 24.4, paper 15.4" in paper_rate(small_bench())


def test_growth_is_told_with_its_exponent_and_base():
    said = plain(growth(grown(technique="a<b", base=0.003)))
    assert said == (
        "<b>a&lt;b</b>: frame time grows as pixels<sup>0.86</sup> (0.83 to 0.90), "
        "beside 3 ms that do not grow"
    )
    flat = {"exponent": Figured(value=0.02, low=-0.07, high=0.11)}
    assert plain(growth(grown().model_copy(update=flat))).endswith(
        "frame time is not seen to grow with pixels: exponent 0.02 (−0.07 to 0.11)"
    )
    open_ended = {"exponent": Figured(value=0.34, low=0.32, high=1.24), "base": 0.0}
    assert plain(growth(grown().model_copy(update=open_ended))).endswith(
        "<sup>0.34</sup> (0.32 to 1.24, with any base that noise hides)"
    )
    lost = grown().model_copy(update={"exponent": Figured(value=NAN, low=NAN, high=NAN)})
    assert "noise hides how frame time grows with pixels" in growth(lost)


def test_the_table_holds_every_point_and_only_columns_with_figures():
    view = speed_view(small_bench())
    table = view.cases[0].table
    headings = [h for _, found in table.groups for h in found]
    assert len(table.lines) == len(bunnies()) and len(headings) == len(table.lines[0].cells)
    line = dict(zip(headings[:4], table.lines[0].cells, strict=False))
    assert plain(line["median"].text) == "65 ms" and plain(line["a second"].text) == "15.4"
    assert plain(line["GPU"].text) == "60 ms"
    assert line["× 1 sample"].number == pytest.approx(0.065 / 0.31)
    assert "GPU" not in [h for _, found in view.cases[2].table.groups for h in found]


@pytest.mark.parametrize(("value", "shown"), [
    (0.9996, "1 s"), (0.0650, "65 ms"), (1.2e-5, "0.012 ms"), (119, "119 s"), (7200, "120 min"),
    (3e6, "50,000 min"), (NAN, "–"),
])  # fmt: skip
def test_times_have_three_digits_and_no_exponent(value, shown):
    assert plain(seconds(value)).replace(" ", "") == shown.replace(" ", "").replace(",", "")


def test_sizes_and_numbers_have_three_digits():
    assert [plain(size(v)) for v in (1.2e8, 4.567e9, 9.999e8, NAN)] == [
        "120 MB", "4.57 GB", "1 GB", "–",
    ]  # fmt: skip
    assert [digits(v) for v in (3.0, 0.0677, -12.34, 0)] == ["3", "0.0677", "−12.3", "0"]


def test_what_is_left_out_is_told_with_its_proof():
    exact = LeftOut(case="crowd", what="a", why="b", exact=True, difference=3.1e-9)
    found = [
        exact,
        exact.model_copy(update={"difference": 0.0, "saved_seconds": 0.0042}),
        exact.model_copy(update={"exact": False, "difference": 0.0004, "interval": 0.002}),
        exact.model_copy(update={"difference": NAN}),
        exact.model_copy(update={"saved_seconds": -1e-4, "saved_low": -0.002, "saved_high": 0.001}),
    ]
    (case,) = speed_view(small_bench(points=crowd()[:1], left_out=found)).cases
    assert [plain(x.difference) for x in case.left_out] == [
        "the frame by relMSE 3.1e−9", "nothing", "the truth by 0.04 %, known within 0.20 %", "–",
        "the frame by relMSE 3.1e−9",
    ]  # fmt: skip
    assert [plain(x.saved) for x in case.left_out] == [
        "–", "4.2 ms", "–", "–", "−0.1 ms (−2 ms to 1 ms)",
    ]  # fmt: skip
