"""Frames on disk: whole, exact, or not there."""

import json
import os
import pickle
import subprocess
import sys

import numpy as np
import OpenImageIO as oiio
import pytest

from scenes import frame as module
from scenes.errors import InputError
from scenes.frame import Frame, load_frame, save_frame, write_text

RNG = np.random.default_rng(3)
RGB = RNG.normal(0, 1e5, (7, 9, 3)).astype(np.float32)
IDS = RNG.integers(0, 255, (7, 9)).astype(np.uint8)


@pytest.mark.parametrize("ids", [None, IDS], ids=["without ids", "with ids"])
def test_a_frame_comes_back_bit_for_bit(tmp_path, ids):
    path = tmp_path / "new" / "folder" / "frame.exr"
    save_frame(Frame(RGB, ids, 1.25, {"seed": 3, "device": "llvmpipe"}), path)
    loaded = load_frame(path)
    np.testing.assert_array_equal(loaded.rgb, RGB)
    assert (loaded.seconds, loaded.provenance) == (1.25, {"seed": 3, "device": "llvmpipe"})
    if ids is None:
        assert loaded.ids is None
    else:
        np.testing.assert_array_equal(loaded.ids, ids)
    assert sorted(p.name for p in path.parent.iterdir()) == ["frame.exr", "frame.json"]


def test_bad_numbers_are_kept_for_the_comparison_to_count(tmp_path):
    bad = RGB.copy()
    bad[0, 0] = np.nan, np.inf, -1
    save_frame(Frame(bad), tmp_path / "bad.exr")
    np.testing.assert_array_equal(load_frame(tmp_path / "bad.exr").rgb, bad)


def test_a_picture_from_outside_needs_no_record(tmp_path):
    save_frame(Frame(RGB, IDS, 1.0), tmp_path / "frame.exr")
    (tmp_path / "frame.json").unlink()
    loaded = load_frame(tmp_path / "frame.exr")
    np.testing.assert_array_equal(loaded.rgb, RGB)
    assert loaded.ids is None and np.isnan(loaded.seconds) and loaded.provenance == {}


@pytest.mark.parametrize("record", ["", "[]", "{}", '{"seconds": "x"}', "{"])
def test_a_record_that_is_not_ours_is_passed_over(tmp_path, record):
    save_frame(Frame(RGB, IDS, 1.0), tmp_path / "frame.exr")
    (tmp_path / "frame.json").write_text(record)
    assert load_frame(tmp_path / "frame.exr").ids is None


@pytest.mark.parametrize("kept", [0.0, 0.1, 0.9])
def test_half_a_frame_is_no_frame(tmp_path, refused, kept):
    path = tmp_path / "frame.exr"
    save_frame(Frame(RGB, IDS, 1.0), path)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(len(whole) * kept)])
    refused(lambda: load_frame(path), "frame.exr", "frame", "export it again")


def test_a_picture_that_another_has_replaced_is_not_taken_for_its_record(tmp_path):
    path, other = tmp_path / "frame.exr", tmp_path / "other.exr"
    save_frame(Frame(RGB, IDS, 1.0), path)
    save_frame(Frame(RGB + 1, IDS, 1.0), other)
    assert load_frame(path).ids is not None
    path.write_bytes(other.read_bytes())
    assert load_frame(path).ids is None


class Killed(BaseException):
    pass


def test_a_write_that_is_killed_leaves_the_old_frame(tmp_path, monkeypatch):
    path = tmp_path / "frame.exr"
    save_frame(Frame(RGB, IDS, 1.0), path)

    def killed(*_):
        raise Killed

    with monkeypatch.context() as patch:
        patch.setattr(module.os, "replace", killed)
        with pytest.raises(Killed):
            save_frame(Frame(2 * RGB, IDS, 2.0), path)
    np.testing.assert_array_equal(load_frame(path).rgb, RGB)


def test_a_new_picture_beside_the_old_record_is_unfinished(tmp_path, monkeypatch):
    path = tmp_path / "frame.exr"
    save_frame(Frame(RGB, IDS, 1.0), path)

    def killed(*_):
        raise Killed

    monkeypatch.setattr(module, "write_text", killed)
    with pytest.raises(Killed):
        save_frame(Frame(2 * RGB, IDS, 2.0), path)
    assert load_frame(path).ids is None


def test_the_same_picture_gives_the_same_bytes_at_any_time(tmp_path):
    save_frame(Frame(RGB, IDS, 1.0), tmp_path / "frame.exr")
    written = oiio.ImageBuf(str(tmp_path / "frame.exr")).spec()
    assert written.getattribute("DateTime") == "1970:01:01 00:00:00"
    before = (tmp_path / "frame.exr").read_bytes()
    save_frame(Frame(RGB, IDS, 2.0), tmp_path / "frame.exr")
    assert (tmp_path / "frame.exr").read_bytes() == before


def test_the_same_picture_written_again_is_finished_throughout(tmp_path, monkeypatch):
    path = tmp_path / "frame.exr"
    save_frame(Frame(RGB, IDS, 1.0), path)

    def killed(*_):
        raise Killed

    monkeypatch.setattr(module, "write_text", killed)
    with pytest.raises(Killed):
        save_frame(Frame(RGB, IDS, 2.0), path)
    assert load_frame(path).seconds == 1.0


@pytest.mark.parametrize("save", ["frame", "text"])
def test_a_folder_that_cannot_be_written_is_refused(tmp_path, refused, save):
    (tmp_path / "file").write_text("in the way")
    path = tmp_path / "file" / "frame.exr"
    with_frame = save == "frame"
    refused(
        lambda: save_frame(Frame(RGB), path) if with_frame else write_text(path, "{}"),
        "frame.exr",
        "cannot be written (File exists)",
        "choose another path",
    )


FULL = """
import resource, sys
import numpy as np
from pathlib import Path
from scenes.frame import Frame, save_frame, write_text
resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
noise = np.random.default_rng(0).random((64, 64, 3), np.float32)
path = Path(sys.argv[1]) / "frame.exr"
save_frame(Frame(noise), path) if sys.argv[2] == "frame" else write_text(path, "x" * 9999)
"""


@pytest.mark.parametrize("save", ["frame", "text"])
def test_a_file_that_the_system_cuts_off_is_refused_and_leaves_nothing(tmp_path, save):
    command = [sys.executable, "-c", FULL, str(tmp_path), save]
    answer = subprocess.run(command, capture_output=True, text=True)
    last = answer.stderr.splitlines()[-1]
    assert last.endswith(
        "frame.exr: cannot be written (File too large); free some room, or choose another folder"
    )
    assert list(tmp_path.iterdir()) == []


def test_text_appears_whole(tmp_path):
    write_text(tmp_path / "a" / "results.json", json.dumps({"α": 1}))
    assert json.loads((tmp_path / "a" / "results.json").read_text()) == {"α": 1}
    assert len(list((tmp_path / "a").iterdir())) == 1


def test_a_mistake_comes_back_whole_from_another_process():
    error = InputError("suite.toml", "truths", "is empty", "name one")
    again = pickle.loads(pickle.dumps(error))
    assert (type(again), str(again), vars(again)) == (InputError, str(error), vars(error))


def test_text_is_utf_8_whatever_the_locale(tmp_path):
    code = (
        "import sys, pathlib, scenes.frame as f; f.write_text(pathlib.Path(sys.argv[1]), '\\u00d7')"
    )
    plain = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    words = [sys.executable, "-c", code, str(tmp_path / "text")]
    subprocess.run(words, env=os.environ | plain, check=True)
    assert (tmp_path / "text").read_bytes() == "\u00d7".encode()
