"""How the tests end, how a user's mistake must read, and a cluster of this one machine."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scenes.errors import InputError

STATUS = pytest.StashKey[int]()
DASK, LOCAL = [sys.executable, "-m", "dask"], ["--host", "127.0.0.1", "--no-dashboard"]


def pytest_sessionfinish(session, exitstatus):
    session.config.stash[STATUS] = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    """Leave without the interpreter's clean-up.

    OpenImageIO's bindings call what modules still hold at exit a leak, in twenty lines that would
    bury the verdict.
    """
    if STATUS in config.stash:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(config.stash[STATUS])


@pytest.fixture(autouse=True)
def _users_results_stay():
    """No test may touch what `make compare` left for its user in reports/out."""
    folder = Path(__file__).parents[1] / "reports/out"
    before = folder.stat().st_mtime_ns if folder.exists() else None
    yield
    assert (folder.stat().st_mtime_ns if folder.exists() else None) == before


@pytest.fixture(autouse=True, scope="session")
def _users_bakes_stay(tmp_path_factory):
    """Bakes that tests make go to a folder of theirs, not to the user's cache."""
    folder = tmp_path_factory.mktemp("bakes")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("renderer.transport.stored.folder", lambda: folder)
        yield


@pytest.fixture
def refused():
    """Call something that must raise InputError whose one line holds all the given words."""

    def check(call, *words: str) -> InputError:
        with pytest.raises(InputError) as caught:
            call()
        error = caught.value
        assert len(str(error).splitlines()) == 1
        assert error.problem and error.remedy and error.remedy in str(error)
        for word in words:
            assert word in str(error)
        return error

    return check


@pytest.fixture(scope="session")
def wait_for():
    """Wait until something is ready."""

    def wait(ready, seconds=60):
        end = time.monotonic() + seconds
        while not ready():
            assert time.monotonic() < end
            time.sleep(0.05)

    return wait


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory, wait_for):
    """The address of a real scheduler, with no workers yet."""
    folder = tmp_path_factory.mktemp("scheduler")
    with subprocess.Popen(
        [*DASK, "scheduler", *LOCAL, "--port", "0", "--scheduler-file", "scheduler.json"],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        cwd=folder,
        stderr=subprocess.DEVNULL,
    ) as process:
        wait_for((folder / "scheduler.json").is_file)
        time.sleep(0.2)
        yield json.loads((folder / "scheduler.json").read_text())["address"]
        process.kill()


@pytest.fixture
def hire(scheduler, tmp_path):
    """Start workers of the scheduler; they are killed when the test ends."""
    hired = []

    def start(count, *arguments, **environment):
        command = [*DASK, "worker", scheduler, *LOCAL, "--nthreads", "1", "--no-nanny"]
        command += ["--death-timeout", "30", *map(str, arguments)]  # none outlives its scheduler
        search = {"PYTHONPATH": os.pathsep.join(sys.path)}
        for _ in range(count):
            process = subprocess.Popen(
                command,
                env=os.environ | search | environment,
                cwd=tmp_path,
                stderr=subprocess.DEVNULL,
            )
            hired.append(process)
        return hired

    yield start
    for process in hired:
        process.kill()
        process.wait()
