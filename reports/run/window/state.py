"""What the window shows: a case, looked at from anywhere, with one thing or another changed."""

import math
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from time import perf_counter

import numpy as np

from reference.batches import truth_of
from reference.store import Store
from renderer.draw import Lit, Prepared, Renderer
from renderer.passes import draw_frame
from renderer.techniques import TECHNIQUES, technique
from reports.display import exposure_for
from reports.run.job import Job
from scenes.environment import FORMATS
from scenes.schema import Case, Environment, Material
from scenes.suite import HERE, Entry, Sampling, shelf_materials, widened

WEIGHTS = (1.0, 0.75, 0.5, 0.25, 0.0)
STEEPEST = math.radians(89)

materials = cache(shelf_materials)


@cache
def environments() -> list[Path]:
    """The environments that come with the project."""
    shelf = HERE / "environments"
    return sorted(p for p in shelf.iterdir() if p.suffix in FORMATS)


@dataclass
class Orbit:
    """The camera, moved around what it looks at; angles in radians."""

    yaw: float = 0.0
    pitch: float = 0.0
    zoom: float = 1.0

    @property
    def moved(self) -> bool:
        """Whether it is no longer the case's own."""
        return (self.yaw, self.pitch, self.zoom) != (0.0, 0.0, 1.0)

    def around(self, case: Case) -> Case:
        """The case seen from here."""
        if not self.moved:
            return case
        target = np.array(case.camera.target)
        back = np.array(case.camera.origin) - target
        distance = float(np.linalg.norm(back))
        azimuth = math.atan2(back[1], back[0]) + self.yaw
        height = math.asin(back[2] / distance) + self.pitch
        height = min(max(height, -STEEPEST), STEEPEST)
        flat = distance * self.zoom * math.cos(height)
        away = (flat * math.cos(azimuth), flat * math.sin(azimuth))
        origin = target + np.array([*away, distance * self.zoom * math.sin(height)])
        camera = case.camera.model_copy(update={"origin": tuple(map(float, origin))})
        return case.model_copy(update={"camera": camera})


@dataclass
class State:
    """What is chosen, and what it takes to draw it.

    Attributes:
        entries: the cases that can be walked through.
        sampling: how their references are traced.
        store: where references are kept.
        techniques: in the order in which they are walked through.
    """

    entries: list[Entry]
    sampling: Sampling
    store: Store
    techniques: tuple[str, ...]
    entry: int = 0
    technique: str = ""
    material: int = -1  # of `materials`; -1 the case's own
    environment: int = -1  # of `environments`; likewise
    weight: int = -1  # of WEIGHTS; likewise
    orbit: Orbit = field(default_factory=Orbit)
    stops: float = 0.0
    reference: bool = False
    said: str = ""
    frame_seconds: float = math.nan
    light_seconds: float = 0.0
    _lit: tuple[str, Lit] | None = None

    @classmethod
    def of(cls, job: Job) -> "State":
        """The state that a window on a job starts with."""
        own = tuple(dict.fromkeys(t for e in job.entries for t in e.techniques))
        known = tuple(dict.fromkeys([*own, *TECHNIQUES]))
        return cls(job.entries, job.suite.reference, Store(job.store), known, technique=own[0])

    @property
    def original(self) -> Case:
        """The suite's case, unchanged."""
        return self.entries[self.entry].case

    @property
    def case(self) -> Case:
        """The case as it is chosen, seen from where one stands."""
        case = self.original
        if self.environment >= 0:
            path = environments()[self.environment]
            light = Environment(name=path.stem, path=path, rotation=case.environment.rotation)
            case = case.model_copy(update={"environment": light})
        if self.material >= 0 or self.weight >= 0:
            objects = (
                o.model_copy(update={"material": self._changed(o.material)}) if o.judged else o
                for o in case.objects
            )
            case = case.model_copy(update={"objects": tuple(objects)})
        return self.orbit.around(case)

    def _changed(self, own: Material) -> Material:
        material = materials()[self.material] if self.material >= 0 else own
        if self.weight < 0:
            return material
        return material.model_copy(update={"weight": WEIGHTS[self.weight]})

    def walk(self, what: str, step: int = 1) -> None:
        """The next (or the one before) of cases, techniques, materials, environments, weights."""
        if what == "case":
            self.entry = (self.entry + step) % len(self.entries)
            self.material = self.environment = self.weight = -1
            self.orbit = Orbit()
        elif what == "technique":
            at = self.techniques.index(self.technique) + step
            self.technique = self.techniques[at % len(self.techniques)]
        else:
            shelves = {"material": materials(), "environment": environments(), "weight": WEIGHTS}
            count = len(shelves[what]) + 1  # and the case's own, which is passed over on the shelf
            at = getattr(self, what)
            setattr(self, what, -1)
            own = self.case
            for _ in range(count):
                at = (at + 1 + step) % count - 1
                setattr(self, what, at)
                if at < 0 or self.case != own:
                    break
        self.said = ""

    def home(self) -> None:
        """Back to the suite's case, from its own camera."""
        self.material = self.environment = self.weight = -1
        self.orbit, self.stops, self.said = Orbit(), 0.0, ""

    def drawn(self, size: tuple[int, int]) -> np.ndarray | None:
        """The picture at a size, (h, w, 3) linear; None where this technique cannot draw it."""
        shape = self.original.width / self.original.height
        case = self.case
        camera = widened(case.camera, shape, size[0] / size[1])
        case = case.model_copy(update={"camera": camera, "width": size[0], "height": size[1]})
        how = technique(self.technique)
        if what := how.cannot_draw(case.model, [o.material for o in case.objects]):
            self.said = f"{self.technique} cannot draw {what}"
            return None
        prepared = self._prepared(Renderer(how), case)
        start = perf_counter()
        draw_frame(prepared)
        self.frame_seconds = perf_counter() - start
        picture = prepared.target.read()
        prepared.target.release()
        return np.ascontiguousarray(picture)

    def traced(self) -> np.ndarray | None:
        """The mean of what the store holds of the `global` reference of just this view."""
        batches = self.store.load(self.case, "model", self.sampling)
        if not batches:
            self.said = "no reference of this view in the store; Home goes back to the suite's"
            return None
        light = [truth_of(b, "global").rgb for b in batches]
        return np.mean(light, axis=0, dtype=np.float64).astype(np.float32)

    def exposure(self, picture: np.ndarray) -> float:
        """The display scale of a picture: its median at middle grey, and the chosen stops."""
        return exposure_for(picture, np.ones(picture.shape[:2], bool)) * 2.0**self.stops

    def _prepared(self, renderer: Renderer, case: Case) -> Prepared:
        """The case ready to be drawn; the light in it is kept while only the camera moves."""
        environment, _ = renderer.environment(case)
        still = case.model_copy(update={"camera": self.original.camera})
        still = still.model_copy(update={"width": 1, "height": 1})
        key = f"{renderer.technique.name} {still.model_dump_json()}"
        if self._lit is None or self._lit[0] != key:
            start = perf_counter()
            self._lit = key, renderer.light(case, environment.maps)
            self.light_seconds = perf_counter() - start
        return renderer.prepare(case, environment.maps, lit=self._lit[1])

    @property
    def words(self) -> list[str]:
        """What is shown, in a few lines."""
        case = self.case
        things = ", ".join(
            f"{o.material.name} (weight {o.material.weight:g})" for o in case.objects if o.judged
        )
        lines = [
            f"{case.scene} in {case.environment.name}: {things}",
            "reference (path-traced)" if self.reference else
            f"{self.technique}: {1e3 * self.frame_seconds:.1f} ms a frame",
        ]  # fmt: skip
        if self.stops:
            lines.append(f"{self.stops:+g} EV")
        if self.said:
            lines.append(self.said)
        return lines
