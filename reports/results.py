"""results.json: its schema, documented and versioned, and its verdicts."""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, PlainSerializer, WithJsonSchema, field_validator

from reports.record import Record, load, save
from scenes.suite import Budget

SCHEMA_VERSION = 3
Verdict = Literal["pass", "fail", "inconclusive", "reported"]


def _plain(value: float) -> float | None:
    """JSON has no NaN or Inf: they are written as null."""
    return value if value == value and abs(value) != float("inf") else None


Figure = Annotated[
    float,
    BeforeValidator(lambda v: float("nan") if v is None else v),
    PlainSerializer(_plain, when_used="json"),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "null"}]}),
]
Interval = tuple[Figure, Figure]
# By factory, since a NaN as plain default has no place in a JSON Schema.
UNKNOWN = Field(default_factory=lambda: float("nan"))
UNKNOWN_INTERVAL = Field(default_factory=lambda: (float("nan"),) * 2)
UNKNOWN_RGB_INTERVALS = Field(default_factory=lambda: ((float("nan"),) * 2,) * 3)
UNKNOWN_RGB = Field(default_factory=lambda: (float("nan"),) * 3)


# What pages read of a run's provenance, beyond what they show as it stands.
TOLD: dict[str, dict[str, type]] = {
    "parity": {"name": str, "passed": bool, "detail": str},
    "references": {"code": str, "mitsuba": str, "drjit": str, "ours": bool},
}


Key = tuple[str, str, str, str]  # case, object, technique, truth


class Keyed(Record):
    """What is said of one object of a case: one technique against one truth."""

    case: str
    object: str
    technique: str
    truth: str

    @property
    def key(self) -> Key:
        """What tells it from all others of a run."""
        return self.case, self.object, self.technique, self.truth

    @property
    def named(self) -> str:
        """The same in words."""
        return f"{self.case} {self.object}, {self.technique} against {self.truth}"


class Row(Keyed):
    """One object of one case: one candidate against one truth.

    `picture` names what was compared: of a technique with switches the picture that has what the
    truth has, `<technique>.<truth>` where that takes a switch thrown or another model.
    Errors are fractions (0.01 is 1 %), times are in milliseconds or seconds as named, `_ci95` is
    a 95 % interval, `_se` and `_dof` are a judged figure's standard error and its degrees of
    freedom (of the square, for energy_local). Verdicts hold at `confidence`, wider than 95 %, so
    that all of a suite's do together. A figure that could not be measured is null and `problem`
    says why.
    """

    scene: str
    environment: str
    material: str
    roughness: float
    metallic: float
    weight: float
    weight_g: float
    picture: str
    ssim: Figure = UNKNOWN
    ssim_ci95: Interval = UNKNOWN_INTERVAL
    ssim_se: Figure = UNKNOWN
    ssim_dof: Figure = UNKNOWN
    ssim_raw: Figure = UNKNOWN
    ssim_raw_ci95: Interval = UNKNOWN_INTERVAL
    ssim_p5: Figure = UNKNOWN
    ssim_p5_ci95: Interval = UNKNOWN_INTERVAL
    ssim_highlights: Figure = UNKNOWN
    ssim_highlights_ci95: Interval = UNKNOWN_INTERVAL
    energy_error: Figure = UNKNOWN
    energy_ci95: Interval = UNKNOWN_INTERVAL
    energy_se: Figure = UNKNOWN
    energy_dof: Figure = UNKNOWN
    energy_rgb: tuple[Figure, Figure, Figure] = UNKNOWN_RGB
    energy_rgb_ci95: tuple[Interval, Interval, Interval] = UNKNOWN_RGB_INTERVALS
    energy_local: Figure = UNKNOWN
    energy_local_ci95: Interval = UNKNOWN_INTERVAL
    energy_local_se: Figure = UNKNOWN
    energy_local_dof: Figure = UNKNOWN
    relmse: Figure = UNKNOWN
    relmse_ci95: Interval = UNKNOWN_INTERVAL
    relmse_median: Figure = UNKNOWN
    relmse_median_ci95: Interval = UNKNOWN_INTERVAL
    chroma_error: Figure = UNKNOWN
    chroma_error_ci95: Interval = UNKNOWN_INTERVAL
    flip: Figure = UNKNOWN
    flip_ci95: Interval = UNKNOWN_INTERVAL
    silhouette: Figure = UNKNOWN
    silhouette_ci95: Interval = UNKNOWN_INTERVAL
    nan_pixels: int = 0
    inf_pixels: int = 0
    negative_pixels: int = 0
    pixels: int = 0
    exposure: Figure = UNKNOWN
    frame_ms: Figure = UNKNOWN
    precomputation_ms: Figure = UNKNOWN
    reference_seconds: Figure = UNKNOWN
    reference_spp: int = 0
    reference_batches: int = 0
    budget: dict[str, float] = Field(default_factory=dict)
    margins: dict[str, Figure] = Field(default_factory=dict)
    verdict: Verdict = "reported"
    confidence: Figure = UNKNOWN
    undecided: list[str] = Field(default_factory=list)
    unsharp: list[str] = Field(default_factory=list)
    problem: str = ""
    note: str = ""


class Figured(Record):
    """A figure with its 95 % interval."""

    value: Figure
    low: Figure
    high: Figure


class Cause(Record):
    """A cause of error, or the total of them.

    `energy` is signed light as a fraction of the last truth's, `diffuse` the diffuse lobe's part
    of it; `local` is the signed share of local energy, `ssim` the step that SSIM takes. `parent`
    is the cause that this one is a part of.
    """

    name: str
    parent: str = ""
    energy: Figured
    diffuse: Figured | None = None
    local: Figured
    ssim: Figured | None = None


class Ladder(Keyed):
    """The error of one object by cause, up to the last truth that there is.

    The causes without a parent sum to `total` within the gaps, since they come from different
    batches; `closes` says whether they do, at a confidence for all gaps of a suite together.
    `switched` are the causes that a switch of the candidate works on: its pictures differ there.
    `missing` says how much of the occlusion and interreflection the candidate lacks (1 is all).
    """

    switched: list[str] = Field(default_factory=list)
    causes: list[Cause]
    total: Cause
    energy_gap: Figured
    local_gap: Figured
    closes: bool
    missing: dict[str, Figured] = Field(default_factory=dict)


class Missing(Keyed):
    """A row that the suite asks for and the run did not give."""


class Ratio(Record):
    """The errors of a technique against a truth, over the rows of this run and of another.

    `figure` is one of `energy_error` (without its sign), `energy_local` and `1 - ssim`; a ratio is
    this run's over the other's, null where the other's is hidden by noise.
    """

    technique: str
    truth: str
    figure: str
    rows: int
    other_rows: int
    median: Figure
    other_median: Figure
    median_ratio: Figure
    worst: Figure
    other_worst: Figure
    worst_ratio: Figure


class Beside(Record):
    """Another run, by its suite and file, and how far off this one is beside it."""

    suite: str
    path: str
    ratios: list[Ratio]


class Change(Keyed):
    """How far one figure of a row moved since an earlier run.

    `figure` is a field of Row. Where `paired`, `old` and `new` are of both pictures against one
    reference; `change`, new less old without their signs, is then exact, and `low` to `high` a 95 %
    interval over the object's blocks, which says how evenly it lies. Else they are the two runs'
    figures, with the noise of both, and `reason` says why. `verdict` is `better` or `worse` where
    the change, or unpaired the whole interval, is further than `tolerance`, `unchanged` where it is
    nearer, else `unclear`.
    """

    figure: str
    old: Figure
    new: Figure
    change: Figure
    low: Figure
    high: Figure
    tolerance: float
    paired: bool
    reason: str = ""
    verdict: Literal["better", "worse", "unchanged", "unclear"]


class Incomparable(Keyed):
    """A row that only one of two runs has, or whose change says nothing, and why."""

    reason: str
    lost: bool = False


class Changes(Record):
    """What changed since an earlier run, in the figures of `reports.change`.

    `judged` says whether worse rows fail this run.
    """

    path: str
    suite: str
    created: str
    judged: bool = False
    changes: list[Change]
    incomparable: list[Incomparable] = Field(default_factory=list)


class CaseRecord(Record):
    """Where the pictures of a case lie, relative to results.json.

    `candidates` by the names of pictures; `truths` as two EXRs each, the means of two independent
    halves of the batches, so that maps can be drawn without the reference's noise.
    """

    id: str
    scene: str
    environment: str
    width: int
    height: int
    objects: list[str]
    candidates: dict[str, str]
    truths: dict[str, tuple[str, str]]


class Results(Record):
    """One run of a suite."""

    schema_version: Literal[3] = SCHEMA_VERSION
    suite: str
    suite_path: str
    description: str
    command: str
    created: str
    seconds: Figure
    provenance: dict[str, Any]
    allow_inconclusive: bool
    expected_rows: int
    missing: list[Missing]
    skipped: list[str]
    cases: list[CaseRecord]
    budgets: list[Budget]
    rows: list[Row]
    ladders: list[Ladder] = Field(default_factory=list)
    beside: Beside | None = None
    changed: Changes | None = None
    verdict: Literal["pass", "fail"]
    reasons: list[str]

    @field_validator("provenance")
    @classmethod
    def _told_in_full(cls, provenance: dict[str, Any]) -> dict[str, Any]:
        for name, fields in TOLD.items():
            entries = provenance.get(name) or []
            whole = isinstance(entries, list) and all(
                isinstance(entry, dict)
                and all(isinstance(entry.get(field), kind) for field, kind in fields.items())
                for entry in entries
            )
            if not whole:
                raise ValueError(f"{name} is not a list of {', '.join(fields)}; write it anew")
        return provenance


def save_results(results: Results, path: Path) -> None:
    """Write results.json whole or not at all."""
    save(results, path)


def load_results(path: Path) -> Results:
    """Read a results.json; see `reports.record.load`."""
    return load(Results, path, f"results.json of schema {SCHEMA_VERSION}", "shadeproof compare")
