"""What rows share is told once, and what is a row's own beside it."""

from pathlib import Path

from reports.gate import judge
from reports.telling import again, crossed, notes_of
from tests.reports.pages import BUDGET, Page, results, row, shown_text, written

SMALL = "covers {} pixels, under 10,000: {}"


def noted(*notes, **fields):
    """A row for each note, of objects o0, o1 and so on."""
    made = [row(object=f"o{i}", **fields) for i in range(len(notes))]
    return [r.model_copy(update={"note": n}) for r, n in zip(made, notes, strict=True)]


def test_what_every_row_notes_stands_once():
    few = SMALL.format("3,400", "one of many"), SMALL.format(334, "as o0")
    rows = noted(f"{few[0]}; budget: reached", f"{few[1]}; budget: reached; ssim: wide")
    shared, own = notes_of(rows)
    assert shared == ["covers under 10,000 pixels: one of many", "budget: reached"]
    assert own == ["", "ssim: wide"]


def test_what_not_every_row_notes_stays_beside_it():
    shared, own = notes_of(noted("budget: reached", "", SMALL.format(12, "as another")))
    assert not shared
    assert own == ["budget: reached", "", "covers under 10,000 pixels: as another"]
    assert notes_of(noted("a; b; a")) == ([], ["a; b"]) and notes_of([]) == ([], [])


def test_a_reason_of_two_budgets_is_noted_once():
    rule = BUDGET.model_copy(update={"object": "left", "reason": "reached", "ssim": None})
    other = rule.model_copy(update={"energy_local": None, "ssim": 0.8})
    assert judge(row(), [BUDGET, rule, other]).note == "budget: reached"


def test_the_page_tells_shared_notes_above_its_rows(folder):
    words = shown_text(Page(written(results(noted("reached", "reached; wide")), folder)))
    assert "Every row: reached." in words and words.count("reached") == 1 and "wide" in words


def test_a_grid_has_several_weights_a_line_and_is_half_full():
    assert crossed([("a", 0), ("a", 1), ("b", 0)])
    assert not crossed([("a", 0.5), ("b", 0.5)]) and not crossed([])
    assert not crossed([("a", 0), ("a", 1), ("b", 2), ("c", 3)])


def test_a_case_is_shown_again_by_the_runs_command_in_a_folder_of_its_own():
    run = results([row()], command="shadeproof gate --suite my.toml --verdict-only")
    told = again(run, "spheres.dusk", Path("reports/my out"))
    assert told == (
        "shadeproof gate --suite my.toml --filter spheres.dusk --out 'reports/my out/again'"
    )
    assert again(results([row()], command=""), "spheres.dusk", Path()) == ""


def test_each_case_on_the_page_has_its_command(folder):
    page = Page(written(results([row()], command="shadeproof compare --suite x"), folder))
    assert "shadeproof compare --suite x --filter spheres.dusk --out" in page.text["code"]
