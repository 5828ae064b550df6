"""bench.html in a real browser: its switch, its keys, its tables, on a narrow screen."""

import pytest

from reports.html.figures import GAP
from reports.html.speed import write_page
from reports.html.speed.scatter import MODES
from tests.reports import browser
from tests.reports.benches import bunnies, full_bench

CHECKS = """
const $ = (s) => document.querySelector(s), plot = $(".spots");
const marks = [...plot.querySelectorAll("a")], mark = marks[0];
const frame = plot.getBoundingClientRect();
const share = (m) => { const b = m.getBoundingClientRect();
  return 100 * (b.left + b.width / 2 - frame.left) / frame.width; };
const all = () => marks.map((m) => share(m));
const ticks = () => [...document.querySelectorAll(".frame .x")].map((t) => t.style.cssText).join();
const moves = (name) => marks.map((m) => JSON.parse(m.closest("li").dataset.moves)[name][0]);
const before = ticks();
out.modes = {};
for (const input of document.querySelectorAll("input[name=speed-time]")) {
  input.click();
  const front = $(".frame path.front");
  out.modes[input.value] = { is: all(), want: moves(input.value),
    front: front.getAttribute("d") === JSON.parse(front.dataset.moves)[input.value],
    time: mark.querySelector(".time").textContent,
    stops: plot.querySelectorAll("a[tabindex='0']").length,
    meanings: document.querySelectorAll(".pinned .choice:not([hidden])").length };
}
out.fixed = before === ticks();
out.lonely = [...document.querySelectorAll(".spots")].at(6).querySelector("li").hidden;
$("input[value=warm]").click();
const tip = () => getComputedStyle(document.activeElement.querySelector(".tip")).opacity;
const press = (key) => document.activeElement.dispatchEvent(
  new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
plot.querySelector("a[tabindex='0']").focus();
const steps = [];
for (let i = 0; i < marks.length; i++) {
  steps.push(share(document.activeElement));
  press("ArrowRight");
}
out.steps = steps;
out.shown = tip();
out.hidden = getComputedStyle(marks.at(-1).querySelector(".tip")).opacity;
const boxes = [...document.querySelectorAll(".tip")].map((t) => [t.getBoundingClientRect(),
  t.closest(".frame").getBoundingClientRect()]).filter(([t]) => t.width);
out.inside = boxes.every(([t, f]) => t.left >= f.left - 10 && t.right <= f.right + 10);
const table = $(".points");
const column = () => [...table.tBodies[0].rows].map((r) => r.cells[3].dataset.value);
const button = table.tHead.rows[1].cells[3].querySelector("button");
button.click(); out.up = column(); out.sorted = table.tHead.rows[1].cells[3].ariaSort;
button.click(); out.down = column();
out.wide = document.documentElement.scrollWidth > innerWidth;
"""


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """What a real browser shows on a narrow screen, as a script in the page finds it."""
    folder = tmp_path_factory.mktemp("browser")
    return browser.seen(write_page(full_bench(), folder), CHECKS)


def test_the_switch_moves_every_point_along_axes_that_stay(seen):
    assert list(seen["modes"]) == [m.name for m in MODES] and seen["fixed"]
    for mode in seen["modes"].values():
        assert mode["is"] == pytest.approx(mode["want"], abs=0.3)
        assert mode["front"] and mode["meanings"] == 1
    assert seen["modes"]["over 1"]["is"] != seen["modes"]["warm"]["is"]
    assert seen["modes"]["new light"]["time"] == f"500{GAP}ms"
    assert seen["lonely"]  # it has no time after a change


def test_arrow_keys_go_from_point_to_point_and_show_what_it_is(seen):
    assert len(seen["steps"]) == len(bunnies()) and seen["steps"] == sorted(seen["steps"])
    assert (seen["shown"], seen["hidden"]) == ("1", "0")
    assert all(mode["stops"] == 1 for mode in seen["modes"].values())


def test_nothing_leaves_a_narrow_screen(seen):
    assert seen["inside"] and not seen["wide"]


def test_a_heading_sorts_by_numbers_with_the_unknown_last(seen):
    (up, down), known = (seen["up"], seen["down"]), [v for v in seen["up"] if v]
    assert [float(v) for v in known] == sorted(map(float, known))
    assert up == known + [""] * (len(up) - len(known)) and seen["sorted"] == "ascending"
    assert down == known[::-1] + [""] * (len(up) - len(known))
