"""Pictures and maps of the report: the error that is there, and what could not be drawn."""

import numpy as np
import pytest

from reports.html.colour import NOT_A_NUMBER, SIGNED, SIMILARITY
from reports.html.images import MAPS
from reports.html.png import colour_map, picture
from scenes.frame import Frame, save_frame
from tests.reports.pages import HEIGHT, WIDTH, Page, image, pixels, results, row, written


def test_a_lost_frame_is_told_and_not_fatal(folder):
    (folder / "b.exr").unlink()
    page = Page(written(results([row()]), folder))
    assert "No picture: b.exr: " in page.text["figure"]
    assert image(page, "Candidate of spheres.dusk").shape == (HEIGHT, WIDTH, 4)


def test_maps_show_the_error_that_is_there(folder):
    page = Page(written(results([row(), row(object="right", weight=0.5)]), folder))
    for kind in ("Signed error of spheres.dusk", "Block energy error of spheres.dusk"):
        shown = image(page, kind)
        assert tuple(shown[20, 20]) == (*SIGNED.colours[35], 255)  # +10 % of ±25 %: 25 + 10
        assert tuple(shown[20, 70]) == (*SIGNED.colours[25], 255)  # no error
        assert shown[0, 0, 3] == 0  # off the objects
    assert tuple(image(page, "SSIM of")[24, 70]) == (*SIMILARITY.colours[100], 255)


def test_colour_maps_clip_and_mark_what_is_no_number():
    values = np.array([[-9.0, 0.0, 9.0, np.nan, 0.1]])
    shown = pixels(colour_map(values, np.array([[True, True, True, True, False]]), SIGNED))[0]
    assert tuple(shown[0, :3]) == tuple(SIGNED.colours[0])
    assert tuple(shown[1, :3]) == (0xF7, 0xF7, 0xF7)
    assert tuple(shown[2, :3]) == tuple(SIGNED.colours[-1])
    assert tuple(shown[3, :3]) == NOT_A_NUMBER
    assert shown[4, 3] == 0


def test_pictures_mark_what_is_no_number():
    rgb = np.full((1, 2, 3), 0.18, np.float32)
    rgb[0, 1, 2] = np.nan
    shown = pixels(picture(rgb, 1.0))[0, :, :3]
    assert tuple(shown[0]) == (118,) * 3  # 0.18 after the sRGB curve
    assert tuple(shown[1]) == NOT_A_NUMBER


def test_an_object_off_screen_costs_nothing_else(folder):
    gone = row(object="gone", problem="covers no pixel of the truth", ssim=np.nan)
    run = results([row(), gone])
    run = run.model_copy(update={"cases": [
        c.model_copy(update={"objects": ["left", "right", "gone"]}) for c in run.cases
    ]})  # fmt: skip
    page = Page(written(run, folder))
    assert page.text["figure"].count("No picture: covers no pixel of the truth") == 3  # close-ups
    assert tuple(image(page, "Signed error of spheres.dusk")[20, 20]) == (*SIGNED.colours[35], 255)


@pytest.mark.parametrize("pixels_of_left", [0, 1, 4])
def test_pictures_of_two_by_two(tmp_path, pixels_of_left):
    ids = (np.arange(4) < pixels_of_left).astype(np.uint8).reshape(2, 2)
    rgb = np.full((2, 2, 3), 0.5, np.float32)
    for name in ("paper.exr", "a.exr", "b.exr"):
        save_frame(Frame(rgb, ids), tmp_path / name)
    page = Page(written(results([row(problem="too small", ssim=np.nan)]), tmp_path))
    assert image(page, "Candidate of spheres.dusk").shape == (2, 2, 4)
    assert ("No picture: too small" in page.text["figure"]) == (pixels_of_left == 0)


def test_what_nobody_foresaw_costs_one_picture(folder, monkeypatch):
    def fall(subject):
        raise ZeroDivisionError("no such thing")

    monkeypatch.setitem(MAPS, "blocks", (fall, SIGNED))
    page = Page(written(results([row()]), folder))
    assert page.text["figure"].count("cannot be drawn (ZeroDivisionError: no such thing)") == 1
    assert image(page, "Signed error of spheres.dusk").shape == (HEIGHT, WIDTH, 4)


def test_close_up_of_the_error_says_whose_it_is(folder):
    page = Page(written(results([row()]), folder))
    assert page.text["figcaption"].count("of left only; all else is left grey") == 1
