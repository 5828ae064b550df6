"""bench.json: what each way to draw a case costs and how wrong it is, documented and versioned."""

import hashlib
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, model_validator

from reports.record import Record, load, save
from reports.results import UNKNOWN, Figure, Figured
from scenes.schema import Case

SCHEMA_VERSION = 1
FIGURES = ("energy_local", "one_minus_ssim")  # the errors that are drawn over time
Family = Literal["real-time", "path traced", "denoised"]
Change = Literal["light", "material", "weight", "geometry"]


class Timed(Record):
    """Seconds of warm frames: the median, the quartiles beside it, and how many there were."""

    median: Figure
    low: Figure
    high: Figure
    frames: int


class Error(Record):
    """How wrong one object is against `global`.

    Of a path tracer it is the mean over pictures of 3 seeds (for energy_local of the squares), and
    `low` and `high` hold their spread too.
    """

    object: str
    material: str
    roughness: float
    weight: float
    energy_error: Figured
    energy_local: Figured
    one_minus_ssim: Figured


class Point(Record):
    """One way to draw a case: a technique, or a path tracer at some samples per pixel.

    Attributes:
        digest: of the case as it was drawn (`case_digest`), to tell whether a suite has changed.
        family, name: such as "real-time" and "sampled@16", or "denoised" and "Mitsuba 4 + OIDN".
        samples: per pixel: directions of a technique that samples, paths of a path tracer.
        frame: warm wall clock until the frame is finished, serially, without read-back for a
            technique and with the picture in memory for a path tracer, as each is used.
        gpu: the GPU's own clock for the same frames, where it has one.
        compilation: seconds of shader or kernel compilation, paid once by a program.
        precomputation: seconds for what is made once per environment (or surface).
        preparation: seconds for geometry, targets and uniforms, or a scene and its BVH, from meshes
            and light that are decoded.
        after: seconds until the next finished frame once a thing has changed: the light, the
            materials' alpha and albedo, their share of GGX (between its ends, where a lobe is
            compiled out), or the meshes. Of a path tracer a frame and what the change adds to it.
        memory: bytes that the process grows by at its peak, precomputation included.
        held: bytes of buffers, textures and targets that stay; unknown for a path tracer.
    """

    case: str
    digest: str = ""
    environment: str
    width: int
    height: int
    family: Family
    name: str
    samples: int = 0
    frame: Timed
    gpu: Timed | None = None
    compilation: Figure = 0.0
    precomputation: Figure = 0.0
    preparation: Figure = 0.0
    after: dict[Change, Figure] = Field(default_factory=dict)
    memory: Figure = UNKNOWN
    held: Figure = UNKNOWN
    errors: list[Error] = Field(default_factory=list)

    def seconds_over(self, frames: int) -> float:
        """Seconds a frame where everything is made once for so many frames."""
        once = self.compilation + self.precomputation + self.preparation
        return self.frame.median + once / frames


class EqualError(Record):
    """What a path tracer needs to be as good as a technique.

    `beyond` says that this lies outside of what was measured: "below" one sample (it is better at
    once), or "above" the most. The figures are null then, but for raw local energy above, which
    follows a law (reports/speed/equal_error.py). An upper end is null where it is infinite.
    `ratio` is `seconds` over the technique's frame time: above 1 the technique is faster.
    """

    case: str
    object: str
    technique: str
    against: Family
    figure: str
    samples: Figured
    seconds: Figured
    ratio: Figured
    beyond: Literal["", "below", "above"] = ""


class Growth(Record):
    """How a cost grows: `exponent` is the slope of log cost over log size, with its interval.

    `base` is a cost that does not grow, fitted beside it; 0 where none was found. `frames` says how
    many warm frames each value is the median of; one for what is not a frame.
    """

    over: Literal["pixels", "triangles", "materials", "samples", "environment"]
    technique: str
    cost: Literal["frame", "precomputation", "memory"]
    sizes: list[float]
    values: list[Figure]
    frames: list[int] = Field(default_factory=list)
    exponent: Figured
    base: Figure = 0.0

    @model_validator(mode="after")
    def _a_value_for_each_size(self) -> "Growth":
        if len(self.values) != len(self.sizes) or len(self.frames) not in (0, len(self.sizes)):
            raise ValueError("sizes, values and frames differ in number; measure it anew")
        return self


class LeftOut(Record):
    """One thing that a case does without, and the proof.

    `exact`: with it on the frame is the same, within `difference` (relMSE). Else it is another
    picture, by `difference`; or an approximation of the truth, where `interval` is known: the truth
    moves by `difference` where its interval is `interval`. `saved_seconds` is the median over pairs
    timed in turn, beside their quartiles: below 0 in noise.
    """

    case: str
    what: str
    why: str
    exact: bool
    difference: Figure
    interval: Figure = UNKNOWN
    saved_seconds: Figure = UNKNOWN
    saved_low: Figure = UNKNOWN
    saved_high: Figure = UNKNOWN


class LobeSampling(Record):
    """Directions until the specular lobe of one mixture is known within 1 %, by how it samples.

    `sampler` is the density that directions are drawn from: the GGX lobe's alone (the paper), the
    mixture's own, or the Beckmann lobe's alone. `light` is "furnace" or an environment's name.
    `samples` is null where it is beyond what was tried.
    """

    roughness: float
    weight: float
    cos_theta: float
    sampler: Literal["ggx", "mixture", "beckmann"]
    points: Literal["Hammersley", "random"]
    light: str
    samples: Figured


class Bench(Record):
    """One run of `shadeproof bench`."""

    schema_version: Literal[1] = SCHEMA_VERSION
    suite: str
    suite_path: str
    command: str
    created: str
    seconds: Figure
    provenance: dict[str, Any]
    points: list[Point]
    equal: list[EqualError] = Field(default_factory=list)
    growths: list[Growth] = Field(default_factory=list)
    left_out: list[LeftOut] = Field(default_factory=list)
    lobes: list[LobeSampling] = Field(default_factory=list)
    skipped: list[str] = Field(default_factory=list)


def case_digest(case: Case) -> str:
    """SHA-256 (hex) of a case's JSON: everything that is drawn, with files by their paths."""
    return hashlib.sha256(case.model_dump_json().encode()).hexdigest()


def save_bench(bench: Bench, path: Path) -> None:
    """Write bench.json whole or not at all."""
    save(bench, path)


def load_bench(path: Path) -> Bench:
    """Read a bench.json; see `reports.record.load`."""
    return load(Bench, path, f"bench.json of schema {SCHEMA_VERSION}", "shadeproof bench")
