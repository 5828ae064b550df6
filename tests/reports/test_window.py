"""The live window: what is chosen, what is drawn, and the window itself on a virtual display."""

import os
import shutil
import subprocess
import sys
import time

import numpy as np
import pytest
from PIL import Image

from renderer.draw import Renderer
from renderer.techniques import technique
from reports.run.job import Job
from reports.run.window.state import WEIGHTS, State, environments, materials

pytest.importorskip("moderngl_window")


@pytest.fixture
def state(tiny, tmp_path):
    return State.of(Job("tiny", tmp_path / "out", tmp_path / "store"))


def test_it_starts_with_the_suites_case_and_shows_its_picture(state):
    case = state.original
    assert state.case == case
    drawn = state.drawn((case.width, case.height))
    whole = Renderer(technique(state.technique), repeats=0).render(case)
    assert np.array_equal(drawn, whole.rgb)
    assert state.frame_seconds > 0 and state.technique in " ".join(state.words)


def test_everything_is_walked_through_and_comes_round(state):
    shelves = {"material": materials(), "environment": environments(), "weight": WEIGHTS}
    for what, shelf in shelves.items():
        before, seen = state.case, []
        for _ in range(len(shelf) + 1):
            state.walk(what)
            if state.case == before:
                break
            assert state.case not in seen  # every step shows something else
            seen.append(state.case)
        assert state.case == before and len(seen) >= len(shelf) - 1
        state.walk(what, -1)
        assert state.case == seen[-1]
        state.home()
    names = set()
    for _ in state.techniques:
        names.add(state.technique)
        state.walk("technique")
    assert names == set(state.techniques) and "best" in names


def test_a_material_and_a_weight_are_what_is_drawn(state):
    state.walk("material")
    state.walk("weight", -1)
    for obj, own in zip(state.case.objects, state.original.objects, strict=True):
        if obj.judged:
            assert obj.material.name == materials()[0].name and obj.material.weight == WEIGHTS[-1]
        else:
            assert obj.material == own.material


def test_the_camera_orbits_what_it_looks_at(state):
    before = state.case.camera
    state.orbit.yaw, state.orbit.pitch, state.orbit.zoom = 0.7, 0.2, 0.5
    after = state.case.camera
    far = [np.linalg.norm(np.subtract(c.origin, c.target)) for c in (before, after)]
    assert far[1] == pytest.approx(far[0] / 2) and after.target == before.target
    state.orbit.pitch = 9.0  # never over the top
    assert state.case.camera.origin[2] < before.target[2] + far[0]
    state.home()
    assert state.case.camera == before


def test_light_is_kept_while_only_the_camera_moves(state):
    state.technique = "best"
    (entry,) = state.entries
    planes = tuple(o for o in entry.case.objects if o.mesh == "plane")  # quicker to bake
    state.entries = [
        entry.model_copy(update={"case": entry.case.model_copy(update={"objects": planes})})
    ]
    state.drawn((48, 36))
    kept = state._lit
    state.orbit.yaw = 0.3
    moved = state.drawn((48, 36))
    assert state._lit is kept
    fresh = State(state.entries, state.sampling, state.store, state.techniques, technique="best")
    fresh.orbit.yaw = 0.3
    assert np.array_equal(moved, fresh.drawn((48, 36)))
    state.walk("environment")
    state.drawn((48, 36))
    assert state._lit is not kept


def test_the_reference_is_shown_where_the_store_has_it(tiny, shadeproof, state, tmp_path):
    assert state.traced() is None and "no reference of this view" in state.said
    code, _, err = shadeproof(
        "references", "--suite", "tiny", "--store", tmp_path / "store", "--samples", 8
    )
    assert code == 0, err
    picture = state.traced()
    assert picture.shape == (state.original.height, state.original.width, 3)
    state.orbit.yaw = 0.1
    assert state.traced() is None


def test_what_a_technique_cannot_draw_is_said(state):
    model = state.original.model.model_copy(update={"multiscatter": "on"})
    entry = state.entries[0]
    state.entries = [
        entry.model_copy(update={"case": entry.case.model_copy(update={"model": model})})
    ]
    state.technique = "paper"
    assert state.drawn((8, 8)) is None and "cannot draw" in state.said


@pytest.mark.skipif(not shutil.which("Xvfb"), reason="needs Xvfb")
def test_the_window_opens_and_shows_the_picture(tmp_path):
    """On a virtual display: a picture is there, and a key changes it."""
    display = f":{90 + os.getpid() % 100}"
    server = subprocess.Popen(
        ["Xvfb", display, "-screen", "0", "1100x700x24", "-fbdir", str(tmp_path)],
        stderr=subprocess.DEVNULL,
    )
    try:
        time.sleep(1.5)
        script = tmp_path / "run.py"
        script.write_text(SCRIPT)
        made = subprocess.run(
            [sys.executable, script, tmp_path], env=os.environ | {"DISPLAY": display},
            capture_output=True, text=True, timeout=240, check=False,
        )  # fmt: skip
    finally:
        server.terminate()
    assert made.returncode == 0, made.stderr
    first, second = (np.asarray(Image.open(tmp_path / f"{n}.png")) for n in "ab")
    assert first.std() > 10 and (first != second).any()


SCRIPT = """
import sys
from pathlib import Path
import moderngl_window
from PIL import Image
from reports.run.job import Job
from reports.run.window import show
from reports.run.window.state import State

folder = Path(sys.argv[1])

class Watched(show.Window):
    frames = 0
    def on_render(self, time, frame_time):
        super().on_render(time, frame_time)
        self.frames += 1
        name = {3: "a", 8: "b"}.get(self.frames)
        if name:
            size = self.wnd.buffer_size
            data = self.wnd.fbo.read(components=3)
            shown = Image.frombytes("RGB", size, data).transpose(Image.FLIP_TOP_BOTTOM)
            shown.save(folder / f"{name}.png")
        if self.frames == 4:
            keys = self.wnd.keys
            self.on_key_event(keys.M, keys.ACTION_PRESS, self.wnd.modifiers)
            self.on_mouse_drag_event(0, 0, 40, 10)
        if self.frames == 9:
            self.wnd.close()

Watched.state = State.of(Job("tiny", folder / "out", folder / "store"))
moderngl_window.run_window_config(Watched, args=("--window", "pyglet"))
"""
