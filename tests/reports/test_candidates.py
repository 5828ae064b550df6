"""Candidates from outside: a folder of pictures or a command, right ones and bad ones."""

import sys

import numpy as np
import pytest

from reports.results import load_results
from scenes.frame import Frame, load_frame, save_frame

CASE = "contact.studio"


def rows_of(folder):
    return load_results(folder / "results.json").rows


def test_a_folder_of_pictures_is_a_candidate(shadeproof, tiny, pictures, tmp_path):
    code, _, err = shadeproof(
        "compare", "--suite", "tiny", "--candidate", pictures, "--out", tmp_path / "out"
    )
    assert code == 0, err
    ours = {(r.object, r.truth): r for r in rows_of(tiny) if r.picture == "sampled"}
    theirs = rows_of(tmp_path / "out")
    assert len(theirs) == 12
    for row in theirs:
        assert row.technique == row.picture == "candidate"
        if row.truth != "physical":  # which ours draws with that model
            assert row.energy_error == ours[row.object, row.truth].energy_error


COPY = """
import json, shutil, sys
json.load(open(sys.argv[1]))
shutil.copy({picture!r}, sys.argv[2])
"""


def test_our_own_rows_stand_beside_a_candidates(shadeproof, tiny, pictures, tmp_path):
    words = ("compare", "--suite", "tiny", "--candidate", pictures, "--out", tmp_path / "out")
    code, _, err = shadeproof(*words, "--ours")
    assert code == 0, err
    found = load_results(tmp_path / "out/results.json")
    same = load_results(tiny / "results.json")
    assert {r.technique for r in found.rows} == {"candidate", "paper", "sampled"}
    assert found.expected_rows == len(found.rows) and found.provenance["device"]
    for row in same.rows:
        (twin,) = (r for r in found.rows if r.key == row.key)
        assert twin.energy_local == pytest.approx(row.energy_local)
    assert {f.technique for f in found.ladders} == {"candidate", "paper", "sampled"}


def test_ours_alone_are_asked_for_without_that(shadeproof, tmp_path):
    code, _, err = shadeproof("compare", "--suite", "tiny", "--ours", "--out", tmp_path)
    assert code == 2 and "--ours: there is no candidate" in err


def test_a_command_is_a_candidate(shadeproof, pictures, tmp_path):
    script = tmp_path / "draw.py"
    script.write_text(COPY.format(picture=str(pictures / f"{CASE}.exr")))
    command = f"{sys.executable} {script} {{case}} {{out}}"
    out = tmp_path / "out"
    code, _, err = shadeproof("compare", "--suite", "tiny", "--candidate", command, "--out", out)
    assert code == 0, err
    assert all(not r.problem and r.frame_ms > 0 for r in rows_of(out))


def frame_of(kind):
    rng = np.random.default_rng(0)
    rgb = rng.uniform(0.1, 0.2, (72, 96, 3)).astype(np.float32)
    if kind == "blank":
        rgb[:] = 0
    if kind == "nan":
        rgb[30:40, 40:60] = np.nan
    if kind == "negative":
        rgb[40:44, 40:60, 1] = -0.05
    if kind == "small":
        rgb = rgb[::2, ::2].copy()
    return Frame(rgb)


@pytest.mark.parametrize(
    ("kind", "problem"),
    [
        ("blank", "black"),
        ("nan", "NaN"),
        ("negative", "below zero, by up to 0.05"),
        ("small", "48x36"),
        ("missing", "no such file"),
    ],
)
def test_a_bad_picture_fails_its_own_rows(shadeproof, tmp_path, kind, problem):
    folder = tmp_path / "pictures"
    folder.mkdir()
    name = "other" if kind == "missing" else CASE
    save_frame(frame_of(kind), folder / f"{name}.exr")
    out = tmp_path / "out"
    code, _, err = shadeproof("gate", "--suite", "tiny", "--candidate", folder, "--out", out)
    assert code == 1, err
    rows = rows_of(out)
    assert len(rows) == 12
    assert all(r.verdict == "fail" for r in rows if r.problem)
    assert any(problem in r.problem for r in rows)


def test_what_rounding_leaves_below_zero_is_counted_and_no_failure(shadeproof, pictures, tmp_path):
    frame = load_frame(pictures / f"{CASE}.exr")
    frame.rgb[40:44, 40:60] = [-1e-9, 0.1, -2e-6]
    save_frame(frame, pictures / f"{CASE}.exr")
    words = ("compare", "--suite", "tiny", "--candidate", pictures, "--out", tmp_path / "out")
    assert shadeproof(*words)[0] == 0
    rows = rows_of(tmp_path / "out")
    assert {r.problem for r in rows} == {""}
    assert sum(r.negative_pixels for r in rows) == 4 * 80


@pytest.mark.parametrize(
    ("body", "problem"),
    [
        ("import time; time.sleep(60)", "longer than 1 s"),
        ("raise SystemExit('no light')", "no light"),
        ("", "wrote no picture"),
        ("import sys; open(sys.argv[2], 'w').write('not an EXR')", "cannot be read"),
    ],
)
def test_a_failing_command_fails_its_own_rows(shadeproof, tmp_path, body, problem):
    script = tmp_path / "draw.py"
    script.write_text(body)
    command = f"{sys.executable} {script} {{case}} {{out}}"
    words = ("gate", "--suite", "tiny", "--candidate", command, "--timeout", 1)
    code, _, err = shadeproof(*words, "--out", tmp_path / "out")
    assert code == 1, err
    rows = rows_of(tmp_path / "out")
    assert len(rows) == 12
    assert all(problem in r.problem and r.verdict == "fail" for r in rows)
