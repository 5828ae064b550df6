"""Batches: independent pictures of one truth, made and stored until the caller has enough."""

import hashlib
import os
import platform
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, Future, as_completed
from dataclasses import dataclass, replace
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from reference.executor import Serial, explained
from reference.settings import FEWEST_BATCHES, TRUTHS, Kind, kind_of, rounded_samples
from reference.store import Store, key, mending
from reference.variant import gpu, mitsuba
from scenes.errors import InputError
from scenes.frame import Frame
from scenes.schema import Case
from scenes.suite import Sampling, Truth


@dataclass(frozen=True)
class PathTracer:
    """One of the truths as a renderer: `render(case) -> Frame`."""

    truth: Truth
    samples: int = 256
    seed: int = 0

    def render(self, case: Case) -> Frame:
        """A picture of the case; see `render_batch`."""
        batch = render_batch(case, kind_of(self.truth), self.samples, self.seed)
        return truth_of(batch, self.truth)


def truth_of(batch: Frame, truth: Truth) -> Frame:
    """One truth of a batch as a picture; its layer `diffuse` is light off the diffuse lobe."""
    picture = batch.layers.get(truth, batch.rgb)
    diffuse = batch.layers.get(f"{truth}.diffuse", np.zeros_like(picture))
    return replace(
        batch,
        rgb=picture,
        provenance=batch.provenance | {"truth": truth},
        layers={"diffuse": diffuse},
    )


def render_batch(case: Case, kind: Kind, samples: int, seed: int) -> Frame:
    """Path-trace a case once, for every truth of a kind.

    Args:
        samples: per pixel; `rounded_samples` of it are taken and recorded.
        seed: batches of different seeds are independent.

    Returns:
        A frame with ids: the kind's first truth, the others as layers (see `truth_of`).
        `seconds` is path tracing alone, without set-up and kernel compilation.

    Raises:
        InputError: an input cannot be used, or there is no LLVM to run on.
    """
    start = time.perf_counter()
    ready = _stage(case, kind)
    _without_compilation(lambda: ready.control)
    staged = time.perf_counter()
    layers, compiling = _without_compilation(lambda: ready.trace(samples, seed))
    traced = time.perf_counter()
    provenance = {
        "samples": rounded_samples(samples),
        "seed": seed,
        "notes": ready.notes,
        "traced_pixels": int(ready.traced.sum()),
        "setup_seconds": staged - start,
        "compile_seconds": compiling,
        **_machine(),
    }
    rgb = layers.pop(TRUTHS[kind][0])
    shown = {name: layer for name, layer in layers.items() if "." not in name or layer.any()}
    return Frame(rgb, ready.ids, traced - staged - compiling, provenance, shown)


def grow(
    case: Case,
    kind: Kind,
    sampling: Sampling,
    enough: Callable[[list[Frame]], bool],
    store: Store,
    progress: Callable[[int, int], None] | None = None,
    executor: Executor | None = None,
    frozen: bool = False,
) -> list[Frame]:
    """The stored batches of a reference, with more made until there are enough.

    At least 8 batches, then twice as many each time `enough` says no, up to
    `sampling.max_samples`. Every batch is stored at once, and none is made twice.

    Args:
        enough: asked with all batches so far, in order.
        progress: told after each new batch how many there are and how many are being made.
        executor: traces the batches of a look, all of them submitted at once; this process, one
            after the other, where there is none.
        frozen: trace nothing; what is stored is all there is.

    Raises:
        InputError: as `render_batch`, or the store cannot be written, or a frozen one holds fewer
            than 8 batches.
    """
    batches = {f.provenance["batch"]: f for f in store.load(case, kind, sampling)}
    if frozen:
        if len(batches) < FEWEST_BATCHES:
            raise missing(case, kind, sampling, len(batches), store)
        return [batches[number] for number in sorted(batches)]
    most = sampling.max_samples // sampling.samples_per_batch
    target = FEWEST_BATCHES
    while True:
        tasks = [Task(case, kind, sampling, n) for n in range(target) if n not in batches]
        for task, frame in _trace(tasks, store, executor or Serial()):
            batches[task.number] = frame
            if progress:
                progress(len(batches), max(target, len(batches)))
        ordered = [batches[number] for number in sorted(batches)]
        if len(ordered) >= most or enough(ordered):
            return ordered
        target = min(len(ordered) * 2, most)


def missing(case: Case, kind: Kind, sampling: Sampling, count: int, store: Store) -> InputError:
    """What to say where a reference has too few batches and none may be traced."""
    place = f"reference of kind '{kind}'"
    if damaged := store.damaged(store.homes(case, kind, sampling)):
        return InputError(case.id, place, f"damaged: {damaged[0]}", mending(damaged[0]))
    problem = f"{count} of the {FEWEST_BATCHES} batches it needs are in {store.folder}"
    remedy = "unpack a pack that holds it (`shadeproof refs unpack`), or trace it (`references`)"
    return InputError(case.id, place, problem, remedy)


def all_stored(wanted: Iterable[tuple[Case, Kind, Sampling]], store: Store) -> None:
    """See that every reference has its first 8 batches.

    Raises:
        InputError: the first that has fewer, and whether it is missing or damaged.
    """
    for case, kind, sampling in wanted:
        if (count := len(store.load(case, kind, sampling))) < FEWEST_BATCHES:
            raise missing(case, kind, sampling, count, store)


class Task(NamedTuple):
    """One batch to be made."""

    case: Case
    kind: Kind
    sampling: Sampling
    number: int

    @property
    def identity(self) -> str:
        """The key of the reference that it belongs to."""
        return key(self.case, self.kind, self.sampling)


def lacking(wanted: Iterable[tuple[Case, Kind, Sampling, int]], store: Store) -> list[Task]:
    """What must be made for a whole job: references, and how many batches of each are wanted."""
    tasks: dict[tuple[str, int], Task] = {}
    for case, kind, sampling, count in wanted:
        there = store.files(case, kind, sampling)
        for number in (n for n in range(count) if n not in there):
            task = Task(case, kind, sampling, number)
            tasks.setdefault((task.identity, number), task)
    return list(tasks.values())


def prefetch(
    tasks: list[Task],
    store: Store,
    executor: Executor | None = None,
    progress: Callable[[Task], None] | None = None,
) -> None:
    """Make and store batches, every one submitted before the first is waited for.

    Args:
        progress: told each batch when it is stored.

    Raises:
        InputError: as `grow`.
    """
    for task, _ in _trace(tasks, store, executor or Serial()):
        if progress:
            progress(task)


def trace_batch(task: Task, identity: str) -> tuple[Frame, np.ndarray]:
    """Path-trace one batch, in whatever process and on whatever machine.

    Returns:
        The batch, and where it was traced, (H, W) bool.

    Raises:
        InputError: as `render_batch`, or what is here would make another picture.
    """
    case, kind, sampling, number = task
    try:
        differs = "its code, packages or scene files differ" if task.identity != identity else ""
    except InputError as error:
        differs = f"{error.where} cannot be read ({error.problem})"
    if differs:
        remedy = "give every worker this shadeproof, with the same files at the same paths"
        raise InputError("--cluster", f"worker on {platform.node()}", differs, remedy)
    frame = render_batch(case, kind, sampling.samples_per_batch, batch_seed(identity, number))
    frame.provenance["batch"] = number
    return frame, _stage(case, kind).traced


def _trace(tasks: list[Task], store: Store, executor: Executor) -> Iterator[tuple[Task, Frame]]:
    """Make and store batches; each is told when it is stored, in the order they are finished.

    A batch that fails costs no other: the first failure is raised after the last batch.
    """
    if tasks:
        store.sweep()
    running: dict[Future, Task] = {}
    failures: list[Exception] = []

    def stored(future: Future) -> Iterator[tuple[Task, Frame]]:
        task = running.pop(future)
        try:
            frame, traced = future.result()
        except Exception as error:
            failures.append(explained(error))
            return
        store.save(*task, frame, traced)
        yield task, frame

    try:
        for task in tasks:
            running[executor.submit(trace_batch, task, task.identity)] = task
            # An executor in this process is done by now, and what it made must not wait.
            for future in [f for f in running if f.done()]:
                yield from stored(future)
        for future in as_completed(list(running)):
            yield from stored(future)
    finally:
        for future in running:
            future.cancel()
    if failures:
        raise failures[0]


def batch_seed(identity: str, number: int) -> int:
    """The seed of a batch, 32 bits, from the content that makes the picture and its number."""
    return int.from_bytes(hashlib.sha256(f"{identity}/{number}".encode()).digest()[:4], "big")


def _stage(case: Case, kind: Kind):
    """The case made ready; imported late, so that looking into a store starts no Mitsuba."""
    from reference.truths import stage

    return stage(case, kind)


def _without_compilation(work: Callable[[], Any]) -> tuple[Any, float]:
    """The result of some work, and the seconds that Dr.Jit spent in it making kernels."""
    import drjit as dr

    dr.kernel_history_clear()
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        result = work()
    parts = ("codegen_time", "backend_time")  # in milliseconds
    return result, sum(k.get(part, 0) for k in dr.kernel_history() for part in parts) / 1000


@cache
def _machine() -> dict[str, str]:
    """Versions and device of this process, for the provenance."""
    mi = mitsuba()
    variant = mi.variant()
    facts = {"maker": "mitsuba", "mitsuba": version("mitsuba"), "drjit": version("drjit")}
    facts |= {"variant": variant, "device": gpu() if "cuda" in variant else _processor()}
    if variant.startswith("llvm"):
        facts["llvm"] = Path(os.environ["DRJIT_LIBLLVM_PATH"]).resolve().name
    return facts


def _processor() -> str:
    """The processor's name and how many threads Dr.Jit runs on it."""
    import drjit as dr

    names = []
    if (cpuinfo := Path("/proc/cpuinfo")).is_file():
        lines = cpuinfo.read_text().splitlines()
        names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()}, {dr.thread_count()} threads"
