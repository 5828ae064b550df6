"""Nothing is lost: runs killed at any moment, runs at once, full disks."""

import os
import random
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from reference.store import Store, sound
from tests.reports.small import small_suite

ROOT = Path(__file__).resolve().parents[2]
# Many batches of a small picture, to be cut off between them.
SUITE = small_suite(("global", "physical"), samples=4, most=64, size=(64, 48))
BATCHES = 16  # of each of two references


@pytest.fixture(scope="module")
def start(tmp_path_factory):
    """Start `references` for a suite of 32 batches on a store, in a process of its own."""
    suite = tmp_path_factory.mktemp("suite") / "cut.toml"
    suite.write_text(SUITE)

    def begin(store, program=(sys.executable, "-m", "reports.cli"), **options):
        command = [*program, "references", "--suite", suite, "--store", store, "--samples", "64"]
        return subprocess.Popen(
            list(map(str, command)),
            cwd=ROOT,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            **options,
        )

    return begin


@pytest.fixture(scope="module")
def undisturbed(start, tmp_path_factory):
    """What a run gives that nothing disturbs: file name -> bytes; and its seconds."""
    store = tmp_path_factory.mktemp("undisturbed")
    begun = time.monotonic()
    process = start(store)
    assert process.wait() == 0, process.stderr.read()
    pictures = pictures_of(store)
    assert len(pictures) == 2 * (BATCHES + 1)
    return pictures, time.monotonic() - begun


def pictures_of(store):
    return {str(p.relative_to(store)): p.read_bytes() for p in store.glob("[!.]*/[!.]*.exr")}


def finished(store):
    """The batches that are stored, with the time of their last change."""
    found = [p for p in store.glob("*/batch-*.exr") if p.with_suffix(".json").is_file()]
    return {p: p.read_bytes() for p in found if sound(p)}


@pytest.mark.parametrize(
    "kills", [2, pytest.param(20, marks=pytest.mark.long)], ids=["2 kills", "20 kills"]
)
def test_a_run_that_is_killed_loses_no_finished_batch(start, undisturbed, tmp_path, kills):
    pictures, seconds = undisturbed
    moments, killed, store, compared = random.Random(kills), 0, tmp_path / "store", 0
    while killed < kills:
        before = finished(store)
        process = start(store)
        # Half of them among the batches themselves, half anywhere, from the start on.
        if killed % 2:
            time.sleep(moments.uniform(0, seconds))
        else:
            wanted = min(len(before) + moments.randint(1, 8), 2 * BATCHES - 1)
            while process.poll() is None and len(list(store.glob("*/batch-*.json"))) < wanted:
                time.sleep(0.001)
        process.kill()
        killed += process.wait() != 0
        after = finished(store)
        assert all(after.get(path) == data for path, data in before.items())
        assert Store(store).damaged() == []
        if len(after) == 2 * BATCHES or killed == kills:
            process = start(store)
            assert process.wait() == 0, process.stderr.read()
            assert pictures_of(store) == pictures
            assert all(sound(store / name) for name in pictures)
            compared += 1
            for path in store.iterdir():
                shutil.rmtree(path)
    assert compared


def test_two_runs_at_once_share_a_store(start, undisturbed, tmp_path):
    pictures, _ = undisturbed
    both = [start(tmp_path) for _ in range(2)]
    assert [p.wait() for p in both] == [0, 0]
    assert pictures_of(tmp_path) == pictures
    assert Store(tmp_path).damaged() == []
    assert not list(tmp_path.rglob(".*"))


def test_what_was_cut_off_an_hour_ago_is_removed(tmp_path):
    store = Store(tmp_path)
    for name in (".1234-unpack/a/b", "key/.5678-batch-000.exr", "blessed/.90-old/x", "key/kept"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("half")
    store.sweep()
    assert len([p for p in tmp_path.rglob("*") if p.is_file()]) == 4  # it may be another run's
    long_ago = time.time() - 4000
    for name in (".1234-unpack", "key/.5678-batch-000.exr", "blessed/.90-old", "key/kept"):
        os.utime(tmp_path / name, (long_ago, long_ago))
    store.sweep()
    assert [p.name for p in tmp_path.rglob("*") if p.is_file()] == ["kept"]


def one_line(process):
    """The message of a run that could not work."""
    message = process.communicate()[1]
    lines = [line for line in message.splitlines() if not line.startswith("[")]
    assert process.returncode == 2
    assert len(lines) == 1, message
    return lines[0]


@pytest.fixture
def small_disk(tmp_path):
    """A disk of 600 kB, where it can be mounted."""
    place = tmp_path / "disk"
    place.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=600k", "tmpfs", str(place)]
    if shutil.which("mount") is None or subprocess.run(command, capture_output=True).returncode:
        pytest.skip("mounting a small disk is not permitted here")
    yield place
    subprocess.run(["umount", str(place)], check=True)


def test_a_full_disk_is_one_line_and_costs_only_what_did_not_fit(start, undisturbed, small_disk):
    pictures, _ = undisturbed
    line = one_line(start(small_disk / "store"))
    assert "cannot be written (No space left on device); free some room" in line
    there = finished(small_disk / "store")
    assert 0 < len(there) < 2 * BATCHES
    for path, data in there.items():
        assert pictures[str(path.relative_to(small_disk / "store"))] == data
    assert not list(small_disk.rglob(".*"))
    assert Store(small_disk / "store").damaged() == []


CUT_OFF_AT = "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (9000, 9000));"
CUT_OFF_AT += "from reports.cli import main; main()"


def test_a_file_that_may_not_grow_is_one_line(start, tmp_path):
    line = one_line(start(tmp_path / "store", (sys.executable, "-c", CUT_OFF_AT)))
    assert "cannot be written (File too large)" in line
    assert not list(tmp_path.rglob(".*")) and not list(tmp_path.rglob("batch-*"))


def test_a_store_that_cannot_be_written_is_one_line(start, tmp_path):
    (tmp_path / "file").write_text("in the way")
    line = one_line(start(tmp_path / "file" / "store"))
    assert line.startswith("error: --store:") and "cannot be written" in line
