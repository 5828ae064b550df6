"""Ctrl-C leaves nothing of a bench behind, and no traceback."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.reports.small import BUNNY

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def suite(tmp_path_factory):
    """The path of the tiny suite."""
    path = tmp_path_factory.mktemp("suite") / "small.toml"
    path.write_text(BUNNY)
    return path


INTERRUPTED = """
import os
from multiprocessing import forkserver
from reports.run.bench import kernels
try:
    with kernels.kept_apart():
        forkserver.ensure_running()
        print(*os.listdir(os.environ["TMPDIR"]), flush=True)
        raise KeyboardInterrupt
except KeyboardInterrupt:
    os._exit(130)  # as reports/cli/main.py
"""


def test_an_interrupted_bench_leaves_no_temporary_folder(tmp_path):
    env = os.environ | {"TMPDIR": str(tmp_path)}
    ran = subprocess.run(
        [sys.executable, "-c", INTERRUPTED], cwd=ROOT, env=env, capture_output=True, text=True
    )
    assert ran.returncode == 130 and not ran.stderr
    assert {name.split("-")[0] for name in ran.stdout.split()} == {"shadeproof", "pymp"}
    assert not list(tmp_path.iterdir())


STOPPED = """
import os, signal, sys, threading, time
from pathlib import Path
from reports.run.bench.realtime import started_anew
from scenes.suite import expand, load_suite
(entry,) = expand(*load_suite(sys.argv[1]))
def stop():
    if sys.argv[2] == "starts":
        time.sleep(0.2)
    while sys.argv[2] == "draws" and not list(Path(os.environ["TMPDIR"]).glob("tmp*")):
        time.sleep(0.01)
    os.killpg(0, signal.SIGINT)
threading.Thread(target=stop, daemon=True).start()
try:
    started_anew(entry.case, "paper")
except BaseException:
    os._exit(130)
"""


@pytest.mark.parametrize("moment", ["starts", "draws"])
def test_a_technique_that_is_interrupted_leaves_no_traceback(suite, tmp_path, moment):
    ran = subprocess.run(
        [sys.executable, "-c", STOPPED, str(suite), moment],
        cwd=ROOT,
        env=os.environ | {"TMPDIR": str(tmp_path)},
        capture_output=True,
        text=True,
        start_new_session=True,
        timeout=60,
    )
    assert (ran.returncode, ran.stderr) == (130, "")
    assert not list(tmp_path.glob("tmp*")), "links to meshes"
