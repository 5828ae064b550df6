"""Pictures and maps of the report: the error that is there, and what could not be drawn."""

import numpy as np
import pytest

from reports.html.colour import ERROR, NOT_A_NUMBER, SIGNED, SIMILARITY
from reports.html.layers import MAPS
from reports.html.png import colour_map, picture
from scenes.frame import Frame, load_frame, save_frame
from tests.reports.pages import (
    HEIGHT,
    WIDTH,
    Page,
    image,
    layer,
    pixels,
    problems,
    results,
    row,
    written,
)


def test_a_lost_frame_is_told_and_not_fatal(folder):
    (folder / "b.exr").unlink()
    text = written(results([row()]), folder)
    assert "No picture: b.exr: " in Page(text).text["figure"]
    told = problems(text)
    assert told["truth", ""].startswith("b.exr: ") and ("candidate", "paper") not in told
    assert layer(text, "candidate", "paper").shape == (HEIGHT, WIDTH, 3)


def test_maps_show_the_error_that_is_there(folder):
    text = written(results([row(), row(object="right", weight=0.5)]), folder)
    blocks = layer(text, "blocks", "paper", "global")
    assert SIGNED.palette[blocks[20, 20]] == tuple(SIGNED.colours[35])  # +10 % of ±25 %: 25 + 10
    assert SIGNED.palette[blocks[20, 70]] == tuple(SIGNED.colours[25])  # no error
    assert blocks[0, 0] == 0  # off the objects
    ssim, flip = (layer(text, kind, "paper", "global") for kind in ("ssim", "flip"))
    assert SIMILARITY.palette[ssim[24, 70]] == tuple(SIMILARITY.colours[100])
    assert ERROR.palette[flip[24, 70]] == tuple(ERROR.colours[0])
    assert flip[24, 24] > 2 > flip[0, 0]
    close_up = image(Page(text), "Signed error of copper")
    inside = close_up[close_up[..., 3] > 0][:, :3]
    assert (inside == SIGNED.colours[35]).all()


def test_pictures_are_the_radiance_that_was_compared(folder):
    text = written(results([row(), row(object="right", weight=0.5)]), folder)
    shown, truth = layer(text, "candidate", "paper"), layer(text, "truth", "global")
    for found, name in ((shown, "paper.exr"), (truth, "a.exr")):
        assert found == pytest.approx(load_frame(folder / name).rgb, rel=2.0**-11)
    objects = layer(text, "objects")
    assert (objects[20, 20], objects[20, 70], objects[0, 0]) == (1, 2, 0)


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
    text = written(run, folder)
    shown = Page(text).text["figure"]
    assert shown.count("No picture: covers no pixel of the truth") == 3  # close-ups
    assert SIGNED.palette[layer(text, "blocks", "paper", "global")[20, 20]] == tuple(
        SIGNED.colours[35]
    )


@pytest.mark.parametrize("pixels_of_left", [0, 1, 4])
def test_pictures_of_two_by_two(tmp_path, pixels_of_left):
    ids = (np.arange(4) < pixels_of_left).astype(np.uint8).reshape(2, 2)
    rgb = np.full((2, 2, 3), 0.5, np.float32)
    for name in ("paper.exr", "a.exr", "b.exr"):
        save_frame(Frame(rgb, ids), tmp_path / name)
    text = written(results([row(problem="too small", ssim=np.nan)]), tmp_path)
    assert layer(text, "candidate", "paper", size=(2, 2)).shape == (2, 2, 3)
    assert ("No picture: too small" in Page(text).text["figure"]) == (pixels_of_left == 0)


def test_what_nobody_foresaw_costs_one_picture(folder, monkeypatch):
    def fall(subjects):
        raise ZeroDivisionError("no such thing")

    monkeypatch.setitem(MAPS, "blocks", (fall, SIGNED))
    text = written(results([row()]), folder)
    assert problems(text) == {
        ("blocks", ""): "it cannot be drawn (ZeroDivisionError: no such thing)"
    }
    assert layer(text, "ssim", "paper", "global").any()


def test_close_up_of_the_error_says_whose_it_is(folder):
    page = Page(written(results([row()]), folder))
    assert page.text["figcaption"].count("of left only; all else is left grey") == 1
