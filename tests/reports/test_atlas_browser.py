"""stability.html in a real browser: its keys, its links, on a narrow screen."""

import pytest

from reports.html.stability import write_page
from tests.reports import browser
from tests.reports.atlases import full_stability

CHECKS = """
const atlas = document.getElementById("map--brdf--against-float64");
const fold = atlas.closest("details"), slices = atlas.querySelector(".slices");
const told = () => atlas.querySelector("output").textContent;
const press = (key, times = 1) => { for (let i = 0; i < times; i++) slices.dispatchEvent(
  new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true })); return told(); };
out.unfolded = fold.open;
out.folded = document.getElementById("atlas--D_ggx").open;
slices.focus();
out.first = told();
out.right = press("ArrowRight");
out.up = press("ArrowUp", 99);
out.next = press("ArrowRight", 16);
out.last = press("ArrowRight", 999);
const box = atlas.querySelectorAll(".cells")[2], frame = box.getBoundingClientRect();
box.dispatchEvent(new PointerEvent("pointermove", { bubbles: true,
  clientX: frame.left + 1, clientY: frame.bottom - 1 }));
out.pointed = told();
out.marked = box.querySelectorAll(".cursor").length;
out.stops = atlas.querySelectorAll("[tabindex='0']").length;
for (const d of document.querySelectorAll("details")) d.open = true;
out.wide = document.documentElement.scrollWidth > innerWidth;
"""


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    page = write_page(full_stability(), tmp_path_factory.mktemp("browser"))
    return browser.seen(page, CHECKS, "#map--brdf--against-float64")


def test_a_link_unfolds_its_map_and_no_other(seen):
    assert seen["unfolded"] and not seen["folded"]


def test_arrow_keys_read_every_cell_slice_after_slice(seen):
    assert seen["first"].startswith("alpha 1e−4, n·v 1e−6, weight 0: 0.0032")
    assert seen["right"].startswith("alpha 1.78e−4, n·v 1e−6, weight 0: ")
    assert seen["up"].startswith("alpha 1.78e−4, n·v 1, weight 0: ")
    assert seen["next"].startswith("alpha 1e−4, n·v 1, weight 1e−7: ")
    assert seen["last"].startswith("alpha 1, n·v 1, weight 1: ")
    assert seen["stops"] == 1


def test_a_pointer_reads_the_cell_below_it(seen):
    assert seen["pointed"].startswith("alpha 1e−4, n·v 1e−6, weight 0.25: ")
    assert seen["marked"] == 1


def test_nothing_leaves_a_narrow_screen(seen):
    assert not seen["wide"]
