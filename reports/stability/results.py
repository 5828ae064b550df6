"""stability.json: where the shaders keep their promises, over every hard input."""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, WithJsonSchema

from reports.record import Record, load, save

SCHEMA_VERSION = 1

# Null means that nothing was tried; a shader that broke is a figure all the same.
Value = Annotated[
    float,
    WithJsonSchema({"anyOf": [{"type": "number"}, {"enum": ["Infinity", "-Infinity", "NaN"]}]}),
]
Masking = Literal["", "paper", "smith"]
Kind = Literal["function", "environment", "mesh", "image", "material"]


class Numbers(Record):
    """A record whose JSON writes what is no finite number as "Infinity", "-Infinity" or "NaN"."""

    model_config = ConfigDict(extra="forbid", ser_json_inf_nan="strings")


class Axis(Numbers):
    """One axis of a map: `name` is that of the input, as commands take it (alpha, n.v, weight)."""

    name: str
    values: list[Value]
    log: bool = False


class Worst(Numbers):
    """The worst point of a map or a part of it, and the command that reproduces it."""

    value: Value
    inputs: dict[str, str]
    command: str


class Map(Numbers):
    """One figure of one function over a grid of inputs.

    Each value is the worst of all directions that were tried there.

    Attributes:
        function: the GLSL function, such as "D_ggx" or "brdf".
        invariant: what must hold, such as "against float64" or "reciprocal".
        masking: that of the model, where it matters.
        why: one sentence: what must hold and why.
        unit: what the values are, in words; 1 stands for the whole.
        axes: of slices, rows and columns.
        values: slices x rows x columns; null where nothing was tried.
        limit: the most (with `at_least`, the range `at_least` to `limit`) that passes; null where
            the figure is reported as it is.
        judged: by axis, the bounds within which the limit holds; of the others all is judged.
        worst: in the judged part, or anywhere where there is no limit.
        beyond: the worst of what lies outside of the judged part.
    """

    function: str
    invariant: str
    masking: Masking = ""
    why: str
    unit: str
    axes: tuple[Axis, Axis, Axis]
    values: list[list[list[Value | None]]]
    limit: Value | None = None
    at_least: Value | None = None
    judged: dict[str, tuple[Value, Value]] = Field(default_factory=dict)
    worst: Worst
    beyond: Worst | None = None
    passed: bool


class HardCase(Numbers):
    """One input that is known to break shaders; `measured` says by words what came of it."""

    name: str
    kind: Kind
    must_hold: str
    why: str
    measured: dict[str, Value]
    passed: bool
    command: str


class Promise(Numbers):
    """A part of the domain on which the renderer keeps its promise.

    Attributes:
        claim: in words, what holds.
        bounds: by input, from where to where.
        limit: the most that `worst` may be.
        worst: what was measured on it.
    """

    claim: str
    bounds: dict[str, tuple[Value, Value]]
    limit: Value | None = None
    worst: Value
    held: bool


class Stability(Numbers):
    """One run of `shadeproof stability`."""

    schema_version: Literal[1] = SCHEMA_VERSION
    created: str
    seconds: Value
    command: str
    provenance: dict[str, Any]
    maps: list[Map]
    hard: list[HardCase] = Field(default_factory=list)
    domain: list[Promise] = Field(default_factory=list)

    @property
    def passed(self) -> bool:
        """Whether every map, case and promise holds."""
        return all(m.passed for m in (*self.maps, *self.hard)) and all(p.held for p in self.domain)


def save_stability(found: Stability, path: Path) -> None:
    """Write stability.json whole or not at all."""
    save(found, path)


def load_stability(path: Path) -> Stability:
    """Read a stability.json; see `reports.record.load`."""
    name = f"stability.json of schema {SCHEMA_VERSION}"
    return load(Stability, path, name, "shadeproof stability")
