"""attack.html and its section in report.html: whole, offline, and true to the records."""

import re

import pytest

from reports.attack.results import save_attack
from reports.html.attack import gate_of, write_page
from reports.html.attack.limits import limits_view
from reports.html.attack.matrix import bug_matrix
from reports.html.attack.view import attack_view, change_of
from reports.html.attack.words import plainly
from reports.limits.results import FalseAlarms, Point, save_limits
from tests.reports.attacks import (
    DEAD,
    EQUAL,
    EVIL,
    FILES,
    LOST,
    SEEN,
    control,
    full_attack,
    full_limits,
    limit,
    mutant,
    realistic,
)
from tests.reports.pages import Page, bare_report, plain, shown_text


def folder_of(folder, attack=None, limits=None):
    """A folder with the records that are given."""
    if attack:
        save_attack(attack, folder / "attack.json")
    if limits:
        save_limits(limits, folder / "limits.json")
    return folder


def page_of(folder, attack=None, limits=None):
    return Page(write_page(folder_of(folder, attack, limits)).read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    return page_of(tmp_path_factory.mktemp("attack"), full_attack(), full_limits())


def test_asks_for_nothing_and_every_link_leads_somewhere(page):
    for _, a in page.elements:
        assert a.get("href", "#").startswith(("#", "data:")) and "src" not in a
    ids = [a["id"] for _, a in page.elements if "id" in a]
    assert len(ids) == len(set(ids))
    assert {a["href"][1:] for t, a in page.elements if t == "a"} <= set(ids)
    assert {a["data-copy"] for t, a in page.elements if "data-copy" in a} <= set(ids)


def test_hostile_names_stay_text(page):
    assert not any("onclick" in a for _, a in page.elements)
    assert shown_text(page).count(EVIL) == 2 + 1  # in both lists of bugs, and a false alarm's name
    assert ".venv/bin/shadeproof attack --out <x>" in page.text["code"]
    assert ".venv/bin/shadeproof limits <y>" in page.text["code"]


def test_the_headline_is_the_score(page, tmp_path):
    said = "The gate catches 57 of 58 injected bugs and passes 20 of 20 harmless rewrites"
    assert page.text["h1"] == said and page.text["title"].startswith(said)
    assert [a["class"] for t, a in page.elements if t == "h1"] == ["verdict fail"]
    fine = page_of(tmp_path, full_attack(mutants=[mutant(), EQUAL, DEAD, control("c")]))
    assert fine.text["h1"].startswith("The gate catches 1 of 1 injected bugs and passes 1 of 1")
    assert [a["class"] for t, a in fine.elements if t == "h1"] == ["verdict pass"]


def test_every_bug_is_counted_once_in_the_bar():
    view = attack_view(full_attack())
    assert {p.kind: p.count for p in view.parts} == {
        "missed": 1, "caught": 57, "equal": 1, "dead": 1,
    }  # fmt: skip


def test_what_was_let_through_comes_first_with_its_diff_and_command(page):
    words = shown_text(page)
    assert 0 < words.index("Let through") < words.index("Limits of detection")
    assert words.index("max(n_dot_v, 1e-4)") < words.index("Limits of detection")
    assert ".venv/bin/shadeproof attack --only 'lost 1'" in words


def test_nothing_is_said_of_what_was_not_let_through(tmp_path):
    words = shown_text(page_of(tmp_path, full_attack(mutants=[mutant()])))
    assert "Let through" not in words and "False alarms" not in words
    assert "Equivalent:" not in words and "Stillborn:" not in words


def test_a_false_alarm_fails_and_is_told(tmp_path):
    cried = control("c-9", outcome="alarm", exit_code=1, by="silver went dark")
    page = page_of(tmp_path, full_attack(mutants=[mutant(), control("c"), cried]))
    assert page.text["h1"].endswith("passes 1 of 2 harmless rewrites")
    assert [a["class"] for t, a in page.elements if t == "h1"] == ["verdict fail"]
    assert "silver went dark" in page.text["section"] and "attack --only c-9" in page.text["code"]


def test_arguments_and_what_saw_a_bug_stand_beside_it(page):
    words = shown_text(page)
    assert EQUAL.equivalent in words and plainly(SEEN) in words and "invalid swizzle" in words


def test_what_drew_nothing_has_one_name(page):
    words = shown_text(page)
    assert "1 stillborn: nothing drawn" in words and "swizzle changed" in words
    assert f"{DEAD.file}:{DEAD.line} stillborn" in words and "drew nothing" not in words


def test_what_ran_out_of_time_counts_for_nothing_and_is_told(tmp_path):
    slow = mutant("slow", outcome="timeout", exit_code=-1)
    cell = bug_matrix([slow], {FILES[0]: "list"}).lines[0][2][0]
    assert (cell.text, cell.note, cell.state) == ("", "1 timeout", "reported")
    waited = control("waited", outcome="timeout", exit_code=-1)
    page = page_of(tmp_path, full_attack(mutants=[mutant(), waited]))
    assert "False alarms" in shown_text(page) and "attack --only waited" in page.text["code"]


def test_a_bug_has_its_name_and_what_it_is(tmp_path):
    bugs = [realistic("half vector", "wi - wo in its place"), mutant("x:12:swizzle:1")]
    words = shown_text(page_of(tmp_path, full_attack(mutants=bugs)))
    assert f"half vector wi - wo in its place {FILES[0]}:12 caught" in words
    assert f"operator {FILES[0]}:12 caught" in words


def test_only_what_differs_is_marked():
    change = change_of("max(n_dot_v, 1e-4)", "max(n_dot_l, 1e-4)")
    assert [t for t, differs in change.before if differs] == ["n_dot_v"]
    assert [t for t, differs in change.after if differs] == ["n_dot_l"]
    for side, text in ((change.before, "max(n_dot_v, 1e-4)"), (change.after, "max(n_dot_l, 1e-4)")):
        assert "".join(t for t, _ in side) == text
    assert change_of("a * b", "a").after == [("a", False)]
    shifted = change_of("    for x:\n        y", "    for z:\n        y")
    assert shifted.before == [("for ", False), ("x", True), (":\n    y", False)]


def test_the_matrix_counts_what_a_user_could_see():
    bugs = [mutant("a", rule="constant"), mutant("b", rule="constant", outcome="survived"), DEAD,
            EQUAL, control("c"), LOST]  # fmt: skip
    found = bug_matrix(bugs, dict.fromkeys(FILES, "list"))
    assert found.rules == ["comparison", "constant", "swizzle"]
    cells = {
        (f, r): c for f, _, line in found.lines for r, c in zip(found.rules, line, strict=True)
    }
    assert len(found.lines) == 3
    both = cells[FILES[0], "constant"]
    assert (both.text, both.state) == ("1/2", "over2")
    assert both.label == f"{FILES[0]}, constant: 1 of 2 caught"
    alone = cells[FILES[2], "comparison"]
    assert (alone.text, alone.note, alone.state) == ("", "1 equivalent", "within1 undecided")
    assert (cells[FILES[0], "swizzle"].state, cells[FILES[1], "swizzle"]) == ("reported", None)
    caught = bug_matrix([mutant()], {FILES[0]: "list"}).lines[0][2][0]
    assert (caught.text, caught.state) == ("1/1", "within2")


def row_of(*found):
    (view,) = limits_view(full_limits(limits=found)).limits
    return view


def side_of(**fields):
    side = row_of(limit(**fields)).plus
    return plain(f"{side.smallest} ({side.ends})")


def test_limits_have_units_signs_and_intervals():
    assert side_of() == "+0.012 (0.0108 to 0.0144)"
    assert side_of(unit="relative") == "+1.2 % (1.08 % to 1.44 %)"
    assert side_of(unit="degrees", high=None, low=0.01) == "+0.012° (0.01° or more)"
    assert side_of(low=None, high=0.02) == "+0.012 (0.02 or less)"
    assert side_of(smallest=None, noiseless=None) == "not even +0.1 ()"
    assert side_of(smallest=None, curve=[]) == "not measured ()"
    assert row_of(limit(smallest=None)).plus.state == "never" != row_of(limit()).plus.state


def test_both_signs_stand_in_one_row_and_differ_where_they_do():
    up, down = limit(), limit(sign="-", smallest=0.02, noiseless=None)
    row = row_of(up, down)
    assert (row.parameter, row.plus.smallest, row.minus.smallest) == (
        "roughness", "+0.012", "−0.02",
    )  # fmt: skip
    assert (row.noiseless, row.by) == ("+0.0096, –", "budget")
    assert row.why == [("", up.words, "sampled@64 vs unoccluded, silver: local energy error")]
    noisy = limit(sign="-", limited_by="noise", words="ssim is .99", seen_by="")
    row = row_of(up, noisy)
    assert row.by == "+ budget, − noise"
    assert [sign for sign, _, _ in row.why] == ["plus", "minus"]
    assert row.why[1] == ("minus", "SSIM is .99", "")
    assert row_of(down).plus is None


def test_the_whole_suite_stands_before_its_techniques(page):
    view = limits_view(full_limits())
    assert len(view.limits) == 4 and len(view.single) == 6
    assert {v.technique for v in view.limits} == {""}
    assert {v.technique for v in view.single} == {"paper", "sampled@64"}
    alone = limits_view(full_limits(limits=[limit(technique="paper")]))
    assert [v.technique for v in alone.limits] == ["paper"] and not alone.single


def curve(*points):
    """Sizes, and how many of 100 are caught."""
    return [Point(size=size, caught=caught, inconclusive=0, of=100) for size, caught in points]


def test_figures_that_contradict_each_other_tell_no_limit():
    back = curve((0.03, 90), (0.04, 70), (0.05, 100))
    assert side_of(curve=back) == "no one limit (caught 90 of 100 at 0.03, but 70 of 100 at 0.04)"
    shaken = curve((0.008, 90), (0.01, 88), (0.012, 95))
    assert side_of(curve=shaken) == side_of() == "+0.012 (0.0108 to 0.0144)"
    assert (
        side_of(noiseless=0.02) == "no one limit (caught from 0.012, but without noise from 0.02)"
    )
    row = row_of(limit(noiseless=0.02))
    assert row.plus.state == "never" and side_of(noiseless=0.012) == side_of()


def test_long_sentences_stand_only_technique_by_technique(page):
    words = shown_text(page)
    said = "the budget leaves 4 % of local energy above the technique's own error"
    assert words.count(said) == 6  # a row for each technique and parameter, both signs in one
    assert words.index("Technique by technique") < words.index(said)
    heads = "errorcaught from, pluscaught from, minuswithout noiselimited by"
    assert f"{heads} roughness" in words and f"{heads}why roughness" in words


def test_the_whole_suites_limits_are_dots_and_what_has_none_is_told():
    plots = {p.title: plain(p.svg) for p in limits_view(full_limits()).plots}
    assert list(plots) == ["On a scale of 0 to 1", "Relative", "Angles"]
    assert "roughness +" in plots["On a scale of 0 to 1"] and "not even" not in plots["Angles"]
    assert "normal tilt −" in plots["Angles"] and "hue +" in plots["Relative"]
    assert "not even +10 %" in plots["Relative"]


def test_a_chart_for_each_parameter_shows_how_often_it_is_caught():
    made = limits_view(full_limits()).curves
    charts = {c.chart.title: c.chart for c in made}
    assert list(charts) == ["roughness", "gain", "normal tilt", "hue"] and len(made) == 4
    chart = charts["roughness"]
    assert chart.header == [
        "error", "paper, plus", "sampled@64, plus", "paper, minus", "sampled@64, minus",
        "whole suite, plus", "whole suite, minus",
    ]  # fmt: skip
    row = next(r for r in chart.rows if r[0] == "0.012")
    assert row[chart.header.index("whole suite, plus")] == "95"


def test_no_line_lies_over_another_and_what_is_never_caught_is_told():
    flat = curve((0.05, 0), (0.1, 0))
    found = [limit(), limit(technique="paper"), limit(technique="b", smallest=None, curve=flat)]
    (shown,) = limits_view(full_limits(limits=found)).curves
    assert shown.chart.header == ["error", "paper"]
    assert shown.said == [
        "The whole suite: plus as paper.", "Never caught: b, plus (up to 0.1).",
    ]  # fmt: skip


def test_more_techniques_than_colours_take_another_chart():
    found = [limit(technique=f"t{k}", smallest=0.01 * (k + 1)) for k in range(5)]
    headers = [c.chart.header for c in limits_view(full_limits(limits=found)).curves]
    assert headers == [["error", "t0", "t1", "t2", "t3"], ["error", "t4"]]


def test_false_alarms_are_told_with_their_bound(tmp_path):
    assert plain(limits_view(full_limits()).sentence) == (
        "No false alarms in 600 judgements of what is right "
        "(95 % interval: up to 1.22 % of those of the renderer as it is)"
    )
    cried = FalseAlarms(what="x", sets=300, alarms=1, inconclusive=0, low=0.0001, high=0.018)
    found = full_limits(limits=[], false_alarms=[cried])
    page = page_of(tmp_path, limits=found)
    assert page.text["h1"] == (
        "The gate ends with 1 in 1 of 300 judgements of what is right: "
        "1 false alarm, 0 inconclusive"
    )
    both = page_of(tmp_path, full_attack(mutants=[mutant()]), found)
    assert both.text["h1"] == "The gate catches 1 of 1 injected bugs. " + page.text["h1"]
    assert [a["class"] for t, a in both.elements if t == "h1"] == ["verdict fail"]


def test_what_is_inconclusive_ends_the_gate_with_1_too(tmp_path):
    unsure = FalseAlarms(what="x", sets=300, alarms=2, inconclusive=34, low=0.001, high=0.02)
    page = page_of(tmp_path, limits=full_limits(limits=[], false_alarms=[unsure]))
    assert page.text["h1"] == (
        "The gate ends with 1 in 36 of 300 judgements of what is right: "
        "2 false alarms, 34 inconclusive"
    )
    assert [a["class"] for t, a in page.elements if t == "h1"] == ["verdict fail"]
    assert "x300 times23436 of 3008.55 % to 16.2 %" in shown_text(page)
    never = unsure.model_copy(update={"alarms": 0})
    alone = limits_view(full_limits(limits=[], false_alarms=[never]))
    assert alone.state == "fail" and "0 false alarms, 34 inconclusive" in alone.sentence


def test_no_figure_reads_nan(page):
    assert not re.search(r"\b(nan|inf|None)\b", shown_text(page))


def test_records_without_content_are_a_page(tmp_path):
    bare = page_of(tmp_path, full_attack(mutants=[]), full_limits(limits=[], false_alarms=[]))
    assert bare.text["h1"] == "No bug was tried on the gate"
    assert "False alarms were not measured" not in shown_text(bare)
    (tmp_path / "attack.json").unlink()
    assert "False alarms were not measured" in page_of(tmp_path).text["h1"]


def test_a_damaged_record_is_told_in_a_line_beside_the_sound_one(tmp_path):
    assert gate_of(tmp_path) is None
    folder_of(tmp_path, limits=full_limits())
    (tmp_path / "attack.json").write_text("{")
    page = page_of(tmp_path)
    assert "is no attack.json of schema 1" in shown_text(page)
    assert "Limits of detection" in shown_text(page)
    assert [a["class"] for t, a in page.elements if t == "h1"] == ["verdict fail"]


def test_the_report_shows_the_attack_that_lies_beside_it(tmp_path):
    heading = "What the gate can and cannot see"
    assert heading not in shown_text(bare_report(tmp_path))
    folder_of(tmp_path, full_attack(), full_limits())
    shown = bare_report(tmp_path)
    assert heading in shown_text(shown) and "catches 57 of 58" in shown_text(shown)
    ids = [a["id"] for _, a in shown.elements if "id" in a]
    assert len(ids) == len(set(ids)) and "gate" in ids
    assert "what the gate sees: something is wrong" in shown.text["header"]
    assert "#gate" in [a["href"] for tag, a in shown.elements if tag == "a"]
    (tmp_path / "attack.json").write_text('{"schema_version": 7}')
    assert "is no attack.json of schema 1" in shown_text(bare_report(tmp_path))


def test_same_records_make_the_same_bytes(tmp_path):
    folder_of(tmp_path, full_attack(), full_limits())
    assert write_page(tmp_path).read_bytes() == write_page(tmp_path).read_bytes()
