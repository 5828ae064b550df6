"""Batches traced elsewhere: in any order, on workers that may be lost."""

import signal
import sys
import time
from concurrent.futures import CancelledError, Executor, Future
from itertools import pairwise

import numpy as np
import pytest
from distributed.scheduler import KilledWorker

from reference import batches, executor
from reference.batches import Task, grow, lacking, prefetch, trace_batch
from reference.store import Store
from scenes.errors import InputError
from scenes.frame import Frame
from scenes.suite import Sampling

FEW = Sampling(samples_per_batch=4, max_samples=80)
# Loaded by every worker: tells when a batch is begun, and takes time for it.
COUNTING = """
import os, time
from reference import batches

true = batches.render_batch

def slow(case, kind, samples, seed):
    with open(os.environ["BEGUN"], "a") as file:
        file.write(f"{os.getpid()} {seed}\\n")
    time.sleep(0.5)
    return true(case, kind, samples, seed)

def dask_setup(worker):
    batches.render_batch = slow
"""


class Backwards(Executor):
    """Does nothing until all is submitted, then the last first."""

    def __init__(self, count):
        self.jobs, self.count = [], count

    def submit(self, fn, /, *args):
        self.jobs.append((future := Future(), fn, args))
        if len(self.jobs) == self.count:
            for waiting, fn, args in reversed(self.jobs):
                try:
                    waiting.set_result(fn(*args))
                except Exception as error:
                    waiting.set_exception(error)
        return future


@pytest.fixture
def fake(monkeypatch):
    """Batches of the seed's own noise, without a path tracer; `fake` lists the seeds."""
    made = []

    def render(case, kind, samples, seed):
        made.append(seed)
        rgb = np.random.default_rng(seed).random((case.height, case.width, 3), np.float32)
        return Frame(rgb, np.ones(rgb.shape[:2], np.uint8), 1.0, {"samples": samples})

    everywhere = type("Stage", (), {"traced": np.ones((36, 48), bool)})()
    monkeypatch.setattr(batches, "render_batch", render)
    monkeypatch.setattr(batches, "_stage", lambda *_: everywhere)
    return made


def same(a, b):
    equal = np.array_equal(a.rgb, b.rgb) and list(a.layers) == list(b.layers)
    return equal and all(np.array_equal(a.layers[n], b.layers[n]) for n in a.layers)


def test_the_order_in_which_batches_come_back_changes_nothing(make_case, tmp_path, fake):
    case, told = make_case(), []
    one = grow(case, "model", FEW, lambda _: True, Store(tmp_path / "one"))
    two = grow(
        case,
        "model",
        FEW,
        lambda _: True,
        Store(tmp_path / "two"),
        lambda *done: told.append(done),
        Backwards(8),
    )
    assert fake[8:] == fake[7::-1]
    assert [f.provenance["batch"] for f in two] == list(range(8))
    assert all(same(a, b) for a, b in zip(one, two, strict=True))
    assert told == [(n, 8) for n in range(1, 9)]


def test_a_batch_in_this_process_is_stored_before_the_next_is_begun(make_case, tmp_path, fake):
    case, store, counts = make_case(), Store(tmp_path / "store"), []
    tasks = lacking([(case, "model", FEW, 3)], store)
    prefetch(tasks, store, progress=lambda _: counts.append((len(fake), len(list_of(store, case)))))
    assert counts == [(1, 1), (2, 2), (3, 3)]


def list_of(store, case):
    return store.load(case, "model", FEW)


def test_a_batch_that_fails_costs_no_other(make_case, tmp_path, fake, monkeypatch):
    case, store, render = make_case(), Store(tmp_path / "store"), batches.render_batch

    def failing(*args):
        frame = render(*args)
        if len(fake) == 3:
            raise InputError("x", "", "failed", "mend it")
        return frame

    monkeypatch.setattr(batches, "render_batch", failing)
    with pytest.raises(InputError, match="mend it"):
        grow(case, "model", FEW, lambda _: True, store)
    assert [f.provenance["batch"] for f in list_of(store, case)] == [0, 1, 3, 4, 5, 6, 7]


def test_a_job_is_submitted_whole_without_what_is_stored_or_asked_twice(make_case, tmp_path, fake):
    cases, store = [make_case(), make_case(width=47)], Store(tmp_path / "store")
    grow(cases[0], "model", FEW, lambda _: True, store)
    wanted = [(c, "model", FEW, 10) for c in (*cases, cases[1].model_copy(update={"id": "again"}))]
    tasks = lacking(wanted, store)
    assert [(t.case.width, t.number) for t in tasks] == [(48, 8), (48, 9)] + [
        (47, n) for n in range(10)
    ]
    assert all(a.identity <= b.identity or a.case.width > b.case.width for a, b in pairwise(tasks))


def test_a_worker_that_would_make_another_picture_says_so(make_case, refused):
    task = Task(make_case(), "model", FEW, 0)
    refused(
        lambda: trace_batch(task, "0" * 64), "--cluster", "code, packages or scene files differ"
    )
    gone = task.case.environment.model_copy(update={"path": "/nowhere.exr"})
    task = task._replace(case=task.case.model_copy(update={"environment": gone}))
    refused(lambda: trace_batch(task, "0" * 64), "/nowhere.exr cannot be read", "same paths")


@pytest.mark.parametrize(
    ("loss", "told"),
    [
        (CancelledError(), "the scheduler was lost"),
        (KilledWorker("trace_batch", None, 3), "every worker that tried it"),
        (RuntimeError("Error during deserialization of the task graph."), "has not our code"),
    ],
    ids=["scheduler", "workers", "code"],
)
def test_the_loss_of_a_cluster_is_one_line(make_case, tmp_path, fake, refused, loss, told):
    class Lost(Executor):
        def submit(self, fn, /, *args):
            future = Future()
            if args[0].number < 3:
                future.set_result(fn(*args))
            else:
                future.set_exception(loss)
            return future

    case, store = make_case(), Store(tmp_path / "store")
    refused(
        lambda: grow(case, "model", FEW, lambda _: True, store, None, Lost()), "--cluster", told
    )
    assert len(list_of(store, case)) == 3


def test_a_cluster_needs_its_package(monkeypatch, refused):
    monkeypatch.setitem(sys.modules, "distributed", None)
    refused(lambda: executor.connect("tcp://127.0.0.1:1"), "--cluster", ".[cluster]")


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "127.0.0.1:1"])
def test_a_scheduler_that_does_not_answer_is_one_line(monkeypatch, refused, address):
    monkeypatch.setattr(executor, "PATIENCE", 1)
    refused(lambda: executor.connect(address), "--cluster", address, "dask scheduler")


@pytest.mark.parametrize(
    "address",
    ["", "bogus", "tcp://host", "tcp://:8786", "tcp://host:port", "http://host:80", "[:1"],
)
def test_what_is_no_address_is_refused_without_a_try(monkeypatch, refused, address):
    monkeypatch.setitem(sys.modules, "distributed", None)
    refused(lambda: executor.connect(address), f"'{address}' is no scheduler's address", "tcp://")


def test_a_scheduler_without_workers_is_one_line(scheduler, monkeypatch, refused):
    monkeypatch.setattr(executor, "PATIENCE", 1)
    refused(lambda: executor.connect(scheduler), "no workers", f"dask worker {scheduler}")


def test_a_worker_killed_half_way_costs_only_its_batch(
    make_case, scheduler, hire, wait_for, tmp_path
):
    case = make_case(np.random.default_rng(8).uniform(0, 2, (32, 64, 3)))
    (tmp_path / "counting.py").write_text(COUNTING)
    begun = tmp_path / "begun"
    workers = hire(2, "--preload", tmp_path / "counting.py", BEGUN=str(begun))
    pool = executor.connect(scheduler)
    wait_for(lambda: len(pool._client.scheduler_info()["workers"]) == 2)

    def kill_one(done, _):
        if done == 4:
            time.sleep(0.2)  # by then it is at its next
            workers[0].send_signal(signal.SIGKILL)

    far = grow(case, "model", FEW, lambda _: True, Store(tmp_path / "far"), kill_one, pool)
    pool._client.close()
    near = grow(case, "model", FEW, lambda _: True, Store(tmp_path / "near"))
    assert all(same(a, b) for a, b in zip(near, far, strict=True))
    stored = Store(tmp_path / "far").load(case, "model", FEW)
    assert all(same(a, b) for a, b in zip(near, stored, strict=True))
    lines = [line.split() for line in begun.read_text().splitlines()]
    assert {pid for pid, _ in lines} == {str(worker.pid) for worker in workers}
    assert len({seed for _, seed in lines}) == 8
    assert len(lines) == 9  # the lost one twice
