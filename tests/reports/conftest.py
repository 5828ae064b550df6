"""One tiny run, shared by the tests of the whole job."""

import json
import shutil
import sys

import numpy as np
import pytest

from renderer import glsl
from reports.cli import main
from scenes.frame import Frame, save_frame
from tests.reports.pages import HEIGHT, WIDTH


@pytest.fixture(scope="session")
def shadeproof(tmp_path_factory):
    """The command in this process: call it with arguments, get (exit code, stdout, stderr)."""
    import contextlib
    import io

    store, folder = tmp_path_factory.mktemp("store"), tmp_path_factory.mktemp("out")

    def call(*words):
        takes_store = words[0] in ("compare", "gate", "references", "bench")
        own = ["--store", store] if takes_store and "--store" not in words else []
        if words[0] in ("compare", "gate", "bench") and "--out" not in words:
            own += ["--out", folder]
        argv = ["shadeproof", *map(str, (*words, *own))]
        out, err = io.StringIO(), io.StringIO()
        before, sys.argv = sys.argv, argv
        try:
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                main()
            code = 0
        except SystemExit as end:
            code = end.code or 0
        finally:
            sys.argv = before
        return code, out.getvalue(), err.getvalue()

    return call


@pytest.fixture(scope="session")
def tiny(shadeproof, tmp_path_factory):
    """The folder of a finished `compare --suite tiny`; treat it as read-only."""
    folder = tmp_path_factory.mktemp("tiny")
    code, out, err = shadeproof("compare", "--suite", "tiny", "--out", folder, "--json")
    assert code == 0, err
    assert json.loads(out)["schema_version"] == 3
    return folder


@pytest.fixture
def pictures(tiny, tmp_path):
    """A folder of EXRs as an outside renderer would leave: here, our own pictures."""
    shutil.copy(tiny / "frames/contact.studio/sampled.exr", tmp_path / "contact.studio.exr")
    return tmp_path


@pytest.fixture
def folder(tmp_path):
    """Frames of two squares: the candidate is 10 % too bright on the left one."""
    ids = np.zeros((HEIGHT, WIDTH), np.uint8)
    ids[8:40, 8:40], ids[8:40, 56:88] = 1, 2
    truth = np.random.default_rng(1).uniform(0.5, 1, (HEIGHT, WIDTH, 3)).astype(np.float32)
    candidate = truth * np.where(ids == 1, np.float32(1.1), 1)[..., None]
    save_frame(Frame(candidate), tmp_path / "paper.exr")
    for name in ("a.exr", "b.exr"):
        save_frame(Frame(truth, ids), tmp_path / name)
    return tmp_path


@pytest.fixture
def broken(monkeypatch):
    """Put a fault into a shader file: this text instead of that."""
    read = glsl._read.__wrapped__

    def put(file: str, right: str, wrong: str):
        assert right in read(file)  # else there would be no fault

        def faulty(name: str) -> str:
            return read(name).replace(right, wrong) if name == file else read(name)

        monkeypatch.setattr(glsl, "_read", faulty)

    return put
