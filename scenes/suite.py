"""A suite file: which scenes, environments, materials and sweeps, and what is good enough."""

import itertools
import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, field_validator, model_validator

from scenes.errors import InputError
from scenes.mesh import FORMATS as MESH_FORMATS
from scenes.environment import FORMATS as ENVIRONMENT_FORMATS
from scenes.schema import (
    PRIMITIVES,
    Camera,
    Case,
    Environment,
    Material,
    Model,
    Object,
    Positive,
    Strict,
    Unit,
    Vector,
    Weight,
    file_safe,
)

HERE = Path(__file__).resolve().parent
Truth = Literal["unoccluded", "global", "physical"]
Resolution = tuple[Annotated[int, Field(gt=0, le=16384)], Annotated[int, Field(gt=0, le=16384)]]
AXES = ("weight", "roughness", "metallic")


class SceneObject(Strict):
    """An object as a scene file writes it: Object, with its material by name or with changes.

    `material` is a name, a path, or a table {use = name, ...fields to change}. `fixed` objects
    keep it whatever a suite crosses or sweeps.
    """

    name: str
    mesh: str
    material: str | dict[str, Any]
    position: Vector = (0.0, 0.0, 0.0)
    rotate: Vector = (0.0, 0.0, 0.0)
    scale: Positive | tuple[Positive, Positive, Positive] = 1.0
    height: Positive | None = None
    judged: bool = True
    fixed: bool = False
    small: str = ""


class Scene(Strict):
    """A scene file: camera, resolution and objects, without light."""

    description: str
    resolution: Resolution
    camera: Camera
    object: Annotated[tuple[SceneObject, ...], Field(min_length=1, max_length=254)]


class Sweep(Strict):
    """Values for one or more axes; several axes are crossed."""

    weight: tuple[Weight, ...] = ()
    roughness: tuple[Unit, ...] = ()
    metallic: tuple[Unit, ...] = ()


class Run(Strict):
    """One scene crossed with environments, materials and sweep axes.

    `materials` replaces the material of every object that is not fixed; what the scene changes
    on an object (`{use = ..., weight = .5}`) stays changed.
    """

    scene: str
    environments: Annotated[tuple[str, ...], Field(min_length=1)]
    rotation: float = 0.0
    materials: tuple[str, ...] = ()
    sweep: Sweep = Sweep()
    resolution: Resolution | None = None
    truths: tuple[Truth, ...] | None = None
    techniques: tuple[str, ...] | None = None


class Sampling(Strict):
    """How long to path-trace: batches of `samples_per_batch` per pixel, up to `max_samples`.

    Batches are added until every judged figure is decided, at least 8 of them.
    """

    samples_per_batch: Annotated[int, Field(gt=0)] = 32
    max_samples: Annotated[int, Field(gt=0)] = 1024

    @model_validator(mode="after")
    def _room_for_eight(self) -> "Sampling":
        if self.max_samples < 8 * self.samples_per_batch:
            raise ValueError("max_samples must be at least 8 batches of samples_per_batch")
        return self


class Budget(Strict):
    """The largest errors (and smallest SSIM) that pass, for the rows that the selectors match.

    A rule with any selector beyond technique and truth is an override and needs a reason.
    Of several rules for a row the last one counts, field by field.
    """

    technique: str
    truth: Truth
    scene: str | None = None
    environment: str | None = None
    object: str | None = None
    material: str | None = None
    weight: Unit | None = None
    reason: str = ""
    energy_error: Positive | None = None
    energy_local: Positive | None = None
    ssim: Unit | None = None
    silhouette: Unit | None = None

    @property
    def selectors(self) -> dict[str, Any]:
        """The fields that narrow the rule to some rows."""
        names = ("scene", "environment", "object", "material", "weight")
        return {n: v for n in names if (v := getattr(self, n)) is not None}

    @model_validator(mode="after")
    def _overrides_say_why(self) -> "Budget":
        if self.selectors and not self.reason:
            raise ValueError("an override needs a 'reason'")
        return self


class Suite(Strict):
    """A suite file, whole."""

    description: str
    techniques: Annotated[tuple[str, ...], Field(min_length=1)]
    truths: Annotated[tuple[Truth, ...], Field(min_length=1)]
    allow_inconclusive: bool = False
    model: Model = Model()
    reference: Sampling = Sampling()
    run: Annotated[tuple[Run, ...], Field(min_length=1)]
    budget: tuple[Budget, ...] = ()

    @field_validator("techniques", "truths")
    @classmethod
    def _once(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        if len(set(names)) != len(names):
            raise ValueError("each name may stand only once")
        return names


class Entry(Strict):
    """A case with the truths and techniques that a suite asks of it."""

    case: Case
    truths: tuple[Truth, ...]
    techniques: tuple[str, ...]


def load_suite(name: str) -> tuple[Suite, Path]:
    """Read a suite by its name in scenes/suites or by path.

    Raises:
        InputError: no such suite, or a field that does not validate.
    """
    path = _find(name, HERE / "suites", (".toml",), Path.cwd(), "--suite", "suite")
    return parse(Suite, read_toml(path), path), path


def expand(suite: Suite, path: Path) -> list[Entry]:
    """Every case of a suite, in file order.

    Args:
        suite: as read from `path`; relative paths in it start at the folder of `path`.

    Raises:
        InputError: a scene, environment, mesh or material is missing or invalid.
    """
    entries = [
        Entry(
            case=case,
            truths=run.truths or suite.truths,
            techniques=run.techniques or suite.techniques,
        )
        for number, run in enumerate(suite.run)
        for case in _cases(suite, run, path, f"run.{number}")
    ]
    ids = [e.case.id for e in entries]
    if twice := {i for i in ids if ids.count(i) > 1}:
        raise InputError(
            path, "run", f"two runs make the case '{min(twice)}'", "remove one of them"
        )
    return entries


def _cases(suite: Suite, run: Run, path: Path, field: str) -> list[Case]:
    """The crossing that one [[run]] asks for."""
    scene_path = _find(run.scene, HERE, (".toml",), path.parent, path, f"{field}.scene")
    scene = parse(Scene, read_toml(scene_path), scene_path)
    width, height = run.resolution or scene.resolution
    axes = [(axis, getattr(run.sweep, axis)) for axis in AXES if getattr(run.sweep, axis)]
    crossing = itertools.product(
        run.environments,
        run.materials or (None,),
        itertools.product(*(values for _, values in axes)),
    )
    cases = []
    for light, material, values in crossing:
        light_path = _find(
            light,
            HERE / "environments",
            ENVIRONMENT_FORMATS,
            path.parent,
            path,
            f"{field}.environments",
        )
        changes = {axis: value for (axis, _), value in zip(axes, values, strict=True)}
        parts = [scene_path.stem, light_path.stem]
        parts += [Path(material).stem] if material else []
        parts += [f"{axis}={value:g}" for axis, value in changes.items()]
        objects = [
            _object(o, material, changes, scene_path, path, f"object.{i}")
            for i, o in enumerate(scene.object)
        ]
        fields = {
            "id": ".".join(parts),
            "scene": scene_path.stem,
            "environment": Environment(
                name=light_path.stem, path=light_path, rotation=run.rotation
            ),
            "camera": scene.camera,
            "width": width,
            "height": height,
            "model": suite.model,
            "objects": objects,
        }
        file_safe(scene_path.stem), file_safe(light_path.stem)
        cases.append(parse(Case, fields, scene_path))
    return cases


def _object(
    entry: SceneObject,
    crossed: str | None,
    changes: dict[str, float],
    scene_path: Path,
    suite_path: Path,
    field: str,
) -> Object:
    """One object with its material found, changed and validated."""
    table = {"use": entry.material} if isinstance(entry.material, str) else dict(entry.material)
    if "use" not in table:
        raise InputError(scene_path, f"{field}.material", "names no material", 'add use = "name"')
    use, home = table.pop("use"), scene_path
    if not entry.fixed:
        table |= changes
        if crossed:
            use, home = crossed, suite_path
    found = _find(str(use), HERE / "materials", (".toml",), home.parent, home, f"{field}.material")
    raw = read_toml(found)
    if "weight" in changes:
        raw.pop("weight_g", None)  # a sweep of the weight moves D and G together
    material = parse(Material, {**raw, **table, "name": found.stem}, found, scene_path, field)
    mesh = entry.mesh
    if mesh not in PRIMITIVES:
        mesh = str(
            _find(
                mesh, HERE / "meshes", MESH_FORMATS, scene_path.parent, scene_path, f"{field}.mesh"
            )
        )
    fields = entry.model_dump(exclude={"material", "mesh", "fixed"})
    return parse(Object, {**fields, "mesh": mesh, "material": material}, scene_path)


def _find(
    name: str, shelf: Path, endings: tuple[str, ...], home: Path, where: str | Path, field: str
) -> Path:
    """A file by its name on our own shelf, or by a path relative to the file that names it."""
    if Path(name).suffix.lower() in endings:
        path = (home / name).resolve()
        if path.is_file():
            return path
        raise InputError(where, field, f"no such file: {path}", "give a path relative to this file")
    for ending in endings:
        if (path := shelf / f"{name}{ending}").is_file():
            return path
    known = sorted({p.stem for e in endings for p in shelf.glob(f"*{e}")})
    raise InputError(
        where, field, f"unknown name '{name}'", f"use one of {', '.join(known)}, or a path"
    )


def read_toml(path: Path) -> dict[str, Any]:
    """Parse a TOML file.

    Raises:
        InputError: it is missing or not TOML.
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(
            path, "", f"cannot be read ({error.strerror})", "check the path"
        ) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(path, "", f"is not TOML ({error})", "mend the syntax") from error


def parse(kind: type, fields: dict[str, Any], path: Path, user: Path | None = None, at: str = ""):
    """Validate fields into `kind`; the first mistake becomes one InputError that names it.

    Args:
        path: the file that the fields come from.
        user: the file whose changes were laid over them, named when the mistake may be there.
    """
    try:
        return kind.model_validate(fields)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = ".".join(str(part) for part in first["loc"]) or kind.__name__.lower()
        problem = first["msg"].removeprefix("Value error, ")
        if first["type"] == "extra_forbidden":
            problem = "unknown field"
            remedy = (
                f"use one of {', '.join(sorted(kind.model_fields))}"
                if len(first["loc"]) == 1
                else ("see scenes/FORMAT.md")
            )
        elif first["type"] == "missing":
            problem, remedy = "is missing", "add it (scenes/FORMAT.md lists the fields)"
        else:
            got = repr(first["input"])
            remedy = "see scenes/FORMAT.md" if len(got) > 60 else f"got {got}"
        place = f"{field} (as changed by {user.name}: {at})" if user else field
        raise InputError(path, place, problem, remedy) from error
