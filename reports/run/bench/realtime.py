"""Techniques under the clock: warm frames in this process, everything else in a fresh one.

A first build tells what compilation takes only where nothing is cached, and peak memory only
where nothing was freed before. So a child process starts each technique anew: it comes from a
fork server, which has this module imported and no OpenGL context, and the driver's shader caches
on disk are off in it.
"""

import os
import signal
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from time import perf_counter

from renderer.context import context, device
from renderer.draw import Prepared, Renderer, draw_frame
from renderer.precompute import Precomputed, precomputed
from renderer.techniques import Technique, technique
from reports.run.bench.memory import growing, held_bytes
from reports.run.bench.way import Cost, Way, changed
from reports.speed.points import Change
from scenes.environment import load_environment
from scenes.mesh import load_mesh
from scenes.schema import PRIMITIVES, Case

NO_CACHES = {"MESA_SHADER_CACHE_DISABLE": "true", "__GL_SHADER_DISK_CACHE": "0"}
QUICK = 0.2  # seconds: changes with quicker frames are measured more than once
LONGEST_QUERY = 2**32 - 1  # nanoseconds that moderngl reads of a query


class RealTime(Way):
    """A technique drawing a case again and again."""

    family = "real-time"

    def __init__(self, case: Case, name: str) -> None:
        self.name, self.case, self.technique = name, case, technique(name)
        self.samples = self.technique.samples
        self.renderer = Renderer(self.technique, repeats=0)
        self.prepared = _prepare(case, self.technique, precomputed(case.environment.path))

    def picture(self):
        """(H, W, 3) linear radiance."""
        return self.renderer.render(self.case).rgb

    def frame(self, seed: int) -> float:
        """Seconds of one frame, until it is finished; nothing is random in it."""
        start = perf_counter()
        draw_frame(self.prepared)
        return perf_counter() - start

    def gpu_frames(self, count: int) -> list[float]:
        """Seconds on the GPU's own clock, of frames of their own; none without a real GPU.

        A software rasteriser answers timer queries too, and what it says is no time of a GPU's.
        """
        if not device().hardware:
            return []
        times = []
        for _ in range(count):
            query = context().query(time=True)
            with query:
                draw_frame(self.prepared)
            if query.elapsed >= LONGEST_QUERY:
                return []
            times.append(query.elapsed * 1e-9)
        return times

    def cost(self, frame: float) -> Cost:
        """What stands beside the frames, measured in a fresh process."""
        return started_anew(self.case, self.name)

    def close(self) -> None:
        """Free the frame's targets."""
        self.prepared.target.release()


def _prepare(case: Case, chosen: Technique, environment: Precomputed) -> Prepared:
    """A case ready to be drawn, with every map that it reads."""
    environment.need(_maps(case, chosen))
    return Renderer(chosen).prepare(case, environment.maps)


def _maps(case: Case, chosen: Technique) -> list[str]:
    return sorted({m for o in case.objects for m in chosen.maps(o.material, case.model)})


def started_anew(case: Case, name: str) -> Cost:
    """What a technique costs besides its frames, measured in a process of its own.

    Meshes and environments are decoded before the clock starts, on both sides of the comparison.
    """
    server = get_context("forkserver")
    server.set_forkserver_preload([__name__])
    with ProcessPoolExecutor(1, mp_context=server) as pool:
        with held_back():
            cost = pool.submit(_cold, case, name)
        return cost.result()


@contextmanager
def held_back() -> Iterator[None]:
    """Hold Ctrl-C back until the block ends, and from the processes that are started in it.

    A terminal sends it to all of them, and one that starts would answer it with a traceback, as
    would one whose parent is gone. `_cold` lets it through again.
    """
    held: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: held.append(number))
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # which is inherited
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        signal.signal(signal.SIGINT, before)
        if held:
            signal.raise_signal(signal.SIGINT)


def _cold(case: Case, name: str) -> Cost:
    """In the child, which Ctrl-C meets here alone: the parent is told of it then."""
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    try:
        return _built_twice(case, name)
    finally:
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})


def _built_twice(case: Case, name: str) -> Cost:
    """Build everything twice, the second time without compilation."""
    os.environ.update(NO_CACHES)
    chosen, path = technique(name), case.environment.path
    load_environment(path)
    with tempfile.TemporaryDirectory() as folder:
        other = _copied_meshes(case, Path(folder))
        for obj in (*case.objects, *other.objects):
            load_mesh(obj.mesh)
        context()
        with growing() as growth:
            first = _Build(case, chosen)
        held = held_bytes()
        first.release()
        again = _Build(case, chosen).release()
        moved = _Build(other, chosen, again.environment).release()
        after: dict[Change, float] = {"light": again.seconds}
        if other != case:
            after["geometry"] = moved.seconds
    for change in ("material", "weight"):
        # The first may be a new variant of the shader, and is not counted.
        steps = range(4 if again.drawing < QUICK else 2)
        builds = [
            _Build(changed(case, change, k), chosen, again.environment).release() for k in steps
        ]
        after[change] = median(b.seconds for b in builds[1:])
    warm = again.precomputing + moved.preparing + moved.drawing
    return Cost(
        compilation=max(first.seconds - warm, 0.0),
        precomputation=again.precomputing,
        preparation=moved.preparing,
        after=after,
        memory=growth.peak,
        held=held,
    )


class _Build:
    """One way from a case to a finished frame, with the seconds that each step took."""

    def __init__(
        self, case: Case, chosen: Technique, environment: Precomputed | None = None
    ) -> None:
        start = perf_counter()
        self.environment = environment or Precomputed(case.environment.path)
        self.environment.need(_maps(case, chosen))
        context().finish()
        ready = perf_counter()
        self.prepared = _prepare(case, chosen, self.environment)
        context().finish()
        prepared = perf_counter()
        draw_frame(self.prepared)
        self.precomputing, self.preparing = ready - start, prepared - ready
        self.seconds = perf_counter() - start
        self.drawing = self.seconds - self.precomputing - self.preparing

    def release(self) -> "_Build":
        """Free the targets."""
        self.prepared.target.release()
        return self


def _copied_meshes(case: Case, folder: Path) -> Case:
    """The case with every mesh file under another name: to the renderer, other geometry."""
    links: dict[str, str] = {}
    for mesh in {o.mesh for o in case.objects} - set(PRIMITIVES):
        link = folder / f"{len(links)}{Path(mesh).suffix}"
        link.symlink_to(mesh)
        links[mesh] = str(link)
    objects = tuple(o.model_copy(update={"mesh": links.get(o.mesh, o.mesh)}) for o in case.objects)
    return case.model_copy(update={"objects": objects})
