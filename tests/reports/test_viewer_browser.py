"""The report in a real browser: pictures, probe, filter and addresses, as a user handles them."""

import shutil
from types import SimpleNamespace

import numpy as np
import pytest

from reports import html
from reports.html import write_report
from reports.html.colour import SIGNED
from scenes.frame import Frame, save_frame
from tests.reports.pages import HEIGHT, WIDTH, results, row

playwright = pytest.importorskip("playwright.sync_api")
CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
CASE = "#case--spheres.dusk"
STAGE = f"{CASE} .stage".replace(".dusk", "\\.dusk")
EDGE = 2  # of 255: smoothing where the picture is enlarged, and the divider's shadow


@pytest.fixture(scope="module")
def chromium():
    if CHROMIUM is None:
        pytest.skip("needs chromium or google-chrome")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def lights(tmp_path):
    """Plain pictures: the candidate (.5, .25, .125), half as much again on the left; .25."""
    ids = np.zeros((HEIGHT, WIDTH), np.uint8)
    ids[8:40, 8:40], ids[8:40, 56:88] = 1, 2
    candidate = np.full((HEIGHT, WIDTH, 3), (0.5, 0.25, 0.125), np.float32)
    candidate[ids == 1] *= 1.5
    save_frame(Frame(candidate), tmp_path / "paper.exr")
    for name in ("a.exr", "b.exr"):
        save_frame(Frame(np.full((HEIGHT, WIDTH, 3), 0.25, np.float32), ids), tmp_path / name)
    return tmp_path


@pytest.fixture
def complaints():
    """What pages said on the console, and what they asked for beside themselves."""
    return SimpleNamespace(heard=[], expected="nothing")


@pytest.fixture
def opened(chromium, lights, complaints):
    """Open the report of two rows; whatever it complains of or asks for fails the test."""
    own = []

    def heard(text):
        if not text.startswith(tuple(own)):
            complaints.heard.append(text)

    def open_page(fragment="", rows=None, **screen):
        run = results(rows or [row(exposure=1.0), row(object="right", weight=0.5, exposure=1.0)])
        path = write_report(run, lights)
        own.extend([path.as_uri(), (lights / html.BESIDE).as_uri()])
        page = chromium.new_page(**{"viewport": {"width": 900, "height": 800}} | screen)
        page.on("console", lambda message: heard(message.text))
        page.on("pageerror", lambda error: heard(str(error)))
        page.on("request", lambda asked: heard(asked.url))
        page.goto(path.as_uri() + fragment)
        page.locator(STAGE).scroll_into_view_if_needed()
        until(page, "document.querySelector('.case').viewer.read")
        return page

    yield open_page
    assert not [text for text in complaints.heard if complaints.expected not in text]


def until(page, condition):
    """Wait for a condition; `wait_for_function` would break the page's own policy."""
    for _ in range(200):
        if page.evaluate(f"Boolean({condition})"):
            return
        page.wait_for_timeout(25)
    raise AssertionError(condition)


def colour(page, x, y):
    """The stage's colour (r, g, b, a) at a share of its width and height."""
    return page.evaluate(
        """([x, y]) => { const from = document.querySelector(".stage canvas");
        const to = new OffscreenCanvas(1, 1).getContext("2d");
        to.drawImage(from, -Math.floor(x * from.width), -Math.floor(y * from.height));
        return [...to.getImageData(0, 0, 1, 1).data]; }""",
        [x, y],
    )


def srgb(*linear):
    return [
        round(255 * (12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055))
        for v in linear
    ]


def near(found, wanted):
    assert np.abs(np.array(found[:3]) - wanted).max() <= EDGE, (found, wanted)


LEFT, RIGHT, OUTSIDE = (0.25, 0.5), (0.75, 0.5), (0.5, 0.06)


def test_the_slider_shows_the_candidate_left_and_the_reference_right(opened):
    page = opened()
    near(colour(page, *LEFT), srgb(0.75, 0.375, 0.1875))
    near(colour(page, *RIGHT), srgb(0.25, 0.25, 0.25))
    page.locator(f"{STAGE}").focus()
    for _ in range(20):
        page.keyboard.press(".")
    near(colour(page, *RIGHT), srgb(0.5, 0.25, 0.125))  # the divider has gone by


def test_the_divider_follows_the_pointer(opened):
    page = opened()
    box = page.locator(STAGE).bounding_box()
    middle = box["y"] + box["height"] / 3
    page.mouse.move(box["x"] + box["width"] / 2, middle)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.1 * box["width"], middle, steps=4)
    page.mouse.up()
    near(colour(page, *LEFT), srgb(0.25, 0.25, 0.25))


def test_a_key_flips_between_the_two(opened):
    page = opened()
    page.locator(STAGE).focus()
    page.keyboard.press("f")
    until(page, "document.querySelector('.stage').dataset.view === 'blink'")
    near(colour(page, *RIGHT), srgb(0.5, 0.25, 0.125))
    page.keyboard.press("f")
    near(colour(page, *RIGHT), srgb(0.25, 0.25, 0.25))


def shown(page, view):
    page.locator(f"{CASE} input[data-axis=view][value={view}]".replace(".dusk", "\\.dusk")).check(
        force=True
    )
    until(page, f"document.querySelector('.stage').dataset.view === '{view}'")


def test_every_view_shows_what_it_says(opened):
    page = opened()
    shown(page, "side")
    near(colour(page, 0.125, 0.5), srgb(0.75, 0.375, 0.1875))
    near(colour(page, 0.625, 0.5), srgb(0.25, 0.25, 0.25))
    shown(page, "difference")
    near(colour(page, *LEFT), srgb(0.5, 0.125, 0.0625))
    shown(page, "signed")
    near(colour(page, *LEFT), SIGNED.colours[-1])  # +75 % of ±25 %
    near(colour(page, *RIGHT), SIGNED.colours[25 + 17])  # a colour for each percent
    assert colour(page, *OUTSIDE)[3] == 0
    shown(page, "blocks")
    near(colour(page, *LEFT), SIGNED.colours[-1])
    shown(page, "ssim")
    assert colour(page, *LEFT)[3] == 255 and colour(page, *OUTSIDE)[3] == 0
    shown(page, "flip")
    assert colour(page, *LEFT)[3] == 255 and colour(page, *OUTSIDE)[3] == 0


def test_exposure_works_on_the_light_and_not_on_the_picture(opened):
    page = opened()
    page.locator(STAGE).focus()
    for _ in range(4):
        page.keyboard.press("[")
    near(colour(page, *LEFT), srgb(0.1875, 0.09375, 0.046875))
    assert page.locator(".stops").inner_text() == "−2 EV"
    slider = page.locator(".exposure input")
    slider.fill("1")
    near(colour(page, *RIGHT), srgb(0.5, 0.5, 0.5))


def test_the_probe_tells_both_sides(opened):
    page = opened()
    box = page.locator(STAGE).bounding_box()
    page.mouse.click(box["x"] + 0.25 * box["width"], box["y"] + 0.5 * box["height"])
    probe = page.locator(".probe")
    until(page, "document.querySelector('.probe .ssim').textContent")
    assert probe.locator(".where").inner_text() == "x 24, y 24, left"
    assert [probe.locator(f".candidate-{c}").inner_text() for c in "rgb"] == [
        "0.75",
        "0.375",
        "0.188",
    ]
    assert [probe.locator(f".truth-{c}").inner_text() for c in "rgb"] == ["0.25"] * 3
    assert probe.locator(".error").inner_text() == "+75 %"
    page.keyboard.press("ArrowRight")
    assert probe.locator(".where").inner_text() == "x 25, y 24, left"
    page.keyboard.press("Shift+ArrowRight")
    page.keyboard.press("Shift+ArrowRight")
    assert probe.locator(".where").inner_text() == "x 45, y 24"


def test_a_link_shows_what_its_sender_saw(opened):
    page = opened("#case--spheres.dusk?view=side&zoom=4&centre=20,20&pixel=60,20&ev=1")
    viewer = "document.querySelector('.case').viewer"
    assert page.evaluate(f"[{viewer}.zoom, {viewer}.stops, ...{viewer}.centre]") == [4, 1, 20, 20]
    assert page.locator(".probe .where").inner_text() == "x 60, y 20, right"
    address = page.evaluate(f"{viewer}.address")
    again = opened(address)
    assert again.evaluate(f"{viewer}.address") == address


def test_a_link_leaves_nothing_of_the_view_before(opened):
    page = opened("#case--spheres.dusk?view=blink&flipped=1&zoom=4&ev=1&pixel=60,20")
    viewer = "document.querySelector('.case').viewer"
    near(colour(page, *RIGHT), srgb(0.5, 0.5, 0.5))  # the reference, a stop brighter
    page.evaluate("location.hash = '#case--spheres.dusk?view=slide&split=0.25'")
    until(page, f"{viewer}.split === 0.25")
    assert page.evaluate(f"[{viewer}.zoom, {viewer}.stops, {viewer}.pixel]") == [1, 0, None]
    assert not page.locator(".probe").is_visible()
    page.evaluate("location.hash = '#%zz'")  # an address that is none
    page.evaluate("location.hash = '#case--spheres.dusk?pixel=10.5,20'")
    until(page, f"{viewer}.pixel")
    assert page.evaluate(f"{viewer}.pixel") == [10, 20]


def test_a_probe_that_is_let_go_tells_nothing(opened):
    page = opened()
    page.locator(STAGE).focus()
    page.keyboard.press("ArrowRight")
    until(page, "document.querySelector('.probe .ssim').textContent")
    assert page.locator(".probe").is_visible()
    page.keyboard.press("Escape")
    assert not page.locator(".probe").is_visible()


def test_a_narrow_window_scrolls_nowhere_sideways(opened):
    page = opened("#case--spheres.dusk?pixel=60,20", viewport={"width": 500, "height": 900})
    until(page, "document.querySelector('.probe .ssim').textContent")
    assert page.evaluate("document.documentElement.scrollWidth") <= 500


def test_zoom_is_the_same_on_both_sides(opened):
    page = opened("#case--spheres.dusk?view=side&zoom=8&centre=8,8")
    # A corner of the left object stands in the middle of each side.
    near(colour(page, 0.3, 0.6), srgb(0.75, 0.375, 0.1875))
    near(colour(page, 0.2, 0.4), srgb(0.5, 0.25, 0.125))


def test_rows_can_be_filtered_and_the_address_says_how(opened):
    page = opened()
    rows = page.locator(".finder tbody tr")
    assert rows.count() == 2
    page.locator(".finder select[name=weight]").select_option("0.5")
    assert page.locator(".finder tbody tr:visible").count() == 1
    assert page.url.endswith("#rows?weight=0.5")
    page.locator(".finder button[type=reset]").click()
    until(page, "document.querySelector('.finder output').textContent === '2 rows'")
    page.locator(".finder input[name=text]").fill("RIGHT")
    assert page.locator(".finder tbody tr:visible").count() == 1
    again = opened("#rows?weight=0.25")
    assert again.locator(".finder tbody tr:visible").count() == 1
    again.evaluate("location.hash = '#rows?text=right'")
    until(again, "document.querySelector('.finder select[name=weight]').value === ''")
    assert again.locator(".finder tbody tr:visible").count() == 1
    again.evaluate("location.hash = '#rows?weight=7'")
    until(again, "document.querySelector('.finder output').textContent === 'no row has weight 7'")


def test_rows_are_sorted_by_a_heading(opened):
    rows = [row(energy_local=0.05), row(object="right", weight=0.5, energy_local=0.15)]
    page = opened(rows=rows)
    first = page.locator(".finder tbody tr").first
    page.get_by_role("button", name="local energy").first.click()
    assert "left" in first.inner_text()
    page.get_by_role("button", name="local energy").first.click()
    assert "right" in first.inner_text()


def test_a_cell_of_the_matrix_leads_to_its_case(opened):
    page = opened()
    page.locator(".matrix td a:visible").first.click()
    assert "#row--spheres.dusk" in page.url
    assert page.locator(STAGE).is_visible()


def test_a_large_report_reads_pictures_from_files_beside_it(opened, lights, monkeypatch):
    monkeypatch.setattr(html, "LARGEST", 1000)
    page = opened()
    assert (lights / html.BESIDE).is_dir()
    near(colour(page, *LEFT), srgb(0.75, 0.375, 0.1875))


def test_a_lost_file_is_told(opened, lights, complaints, monkeypatch):
    monkeypatch.setattr(html, "LARGEST", 1000)
    page = opened()
    for file in (lights / html.BESIDE).glob("*flip*"):
        file.unlink()
    complaints.expected = "ERR_FILE_NOT_FOUND"  # the browser says so too
    shown(page, "flip")
    told = page.locator(f"{STAGE} .nothing").inner_text()
    assert told == "No picture: FLIP: its file is not in the folder report_files beside the page"


def test_a_missing_picture_leaves_the_other(opened, lights):
    (lights / "b.exr").unlink()
    page = opened()
    near(colour(page, *LEFT), srgb(0.75, 0.375, 0.1875))
    assert "No picture: Reference: b.exr" in page.locator(".note").inner_text()
    shown(page, "signed")
    assert "No picture: Reference" in page.locator(f"{STAGE} .nothing").inner_text()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_light_and_dark_both_read(opened, scheme):
    page = opened(color_scheme=scheme)
    ink, paper = page.evaluate(
        "['color', 'background-color'].map((n) => getComputedStyle(document.body)[n])"
    )
    brightness = [sum(map(int, c[4:-1].split(","))) for c in (ink, paper)]
    assert (brightness[0] < brightness[1]) == (scheme == "light")
