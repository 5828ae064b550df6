"""A suite file: which scenes, environments, materials and sweeps, and what is good enough."""

import itertools
import math
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, field_validator, model_validator

from scenes.environment import FORMATS as ENVIRONMENT_FORMATS
from scenes.errors import InputError
from scenes.files import find, parse, read_toml
from scenes.mesh import FORMATS as MESH_FORMATS
from scenes.schema import (
    PAPER,
    PRIMITIVES,
    VERTEX,
    Camera,
    Case,
    Degrees,
    Environment,
    Material,
    ModelOrName,
    Object,
    Pixels,
    Positive,
    Strict,
    Switch,
    Unit,
    Vector,
    Weight,
    file_safe,
    unique_names,
)
from scenes.texture import FORMATS as TEXTURE_FORMATS

HERE = Path(__file__).resolve().parent
Truth = Literal["unoccluded", "direct", "global", "physical", "physical-smith"]
Resolution = tuple[Pixels, Pixels]
SPLIT = ("unoccluded", "direct", "global", "physical")  # the truths that `split_model` needs
# A picture that is black has an energy error of -1: a bound of 1 would let it pass.
Share = Annotated[float, Field(gt=0, lt=1, allow_inf_nan=False, strict=True)]
AXES = ("weight", "roughness", "metallic")


def _once(names: tuple[str, ...]) -> tuple[str, ...]:
    if len(set(names)) != len(names):
        raise ValueError("a name stands twice; leave one")
    return names


Truths = Annotated[tuple[Truth, ...], Field(min_length=1), AfterValidator(_once)]
Techniques = Annotated[tuple[str, ...], Field(min_length=1), AfterValidator(_once)]


class SceneObject(Strict):
    """An object as a scene file writes it: Object, with its material by name or with changes.

    `material` is a name, a path, or a table {use = name, ...fields to change}. `fixed` objects
    keep it whatever a suite crosses or sweeps.
    """

    name: str
    mesh: str
    material: str | dict[str, Any]
    position: Vector = (0.0, 0.0, 0.0)
    rotate: tuple[Degrees, Degrees, Degrees] = (0.0, 0.0, 0.0)
    scale: Positive | tuple[Positive, Positive, Positive] = 1.0
    height: Positive | None = None
    judged: Switch = True
    fixed: Switch = False
    small: str = ""

    @field_validator("name")
    @classmethod
    def _file_safe(cls, name: str) -> str:
        return file_safe(name)


class Scene(Strict):
    """A scene file: camera, resolution and objects, without light."""

    description: str
    resolution: Resolution
    camera: Camera
    object: Annotated[tuple[SceneObject, ...], Field(min_length=1, max_length=254)]

    @field_validator("object")
    @classmethod
    def _names_are_unique(cls, objects: tuple[SceneObject, ...]) -> tuple[SceneObject, ...]:
        unique_names([o.name for o in objects])
        return objects


class Sweep(Strict):
    """Values for one or more axes; several axes are crossed."""

    weight: Annotated[tuple[Weight, ...], Field(min_length=1)] = ()
    roughness: Annotated[tuple[Unit, ...], Field(min_length=1)] = ()
    metallic: Annotated[tuple[Unit, ...], Field(min_length=1)] = ()


class Run(Strict):
    """One scene crossed with environments, materials and sweep axes.

    `materials` replaces the material of every object that is not fixed; what the scene changes
    on an object (`{use = ..., weight = .5}`) stays changed. `model` stands instead of the suite's.
    With `split_model` the model's part of the error is split into Fresnel, kd and masking, for
    which two more references are traced.
    """

    scene: str
    environments: Annotated[tuple[str, ...], Field(min_length=1)]
    rotation: Degrees = 0.0
    materials: tuple[str, ...] = ()
    sweep: Sweep = Sweep()
    resolution: Resolution | None = None
    truths: Truths | None = None
    techniques: Techniques | None = None
    model: ModelOrName | None = None
    split_model: Switch = False


class Sampling(Strict):
    """How long to path-trace: batches of `samples_per_batch` per pixel, up to `max_samples`.

    Batches are added until every judged figure is decided, at least 8 of them.
    """

    samples_per_batch: Annotated[int, Field(gt=0, strict=True)] = 36
    max_samples: Annotated[int, Field(gt=0, strict=True)] = 576

    @model_validator(mode="after")
    def _room_for_eight(self) -> "Sampling":
        if self.max_samples < 8 * self.samples_per_batch:
            raise ValueError(
                f"max_samples {self.max_samples} is less than 8 batches of samples_per_batch "
                f"{self.samples_per_batch}; give at least {8 * self.samples_per_batch}"
            )
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
    energy_error: Share | None = None
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
            raise ValueError('an override has no reason; add reason = "..."')
        return self


class Suite(Strict):
    """A suite file, whole."""

    description: str
    techniques: Techniques
    truths: Truths
    allow_inconclusive: Switch = False
    model: ModelOrName = PAPER
    reference: Sampling = Sampling()
    run: Annotated[tuple[Run, ...], Field(min_length=1)]
    budget: tuple[Budget, ...] = ()


class Entry(Strict):
    """A case with the truths and techniques that a suite asks of it."""

    case: Case
    truths: tuple[Truth, ...]
    techniques: tuple[str, ...]
    split_model: bool = False


def load_suite(name: str) -> tuple[Suite, Path]:
    """Read a suite by its name in scenes/suites or by path.

    Raises:
        InputError: no such suite, or a field that does not validate.
    """
    path = find(name, HERE / "suites", (".toml",), Path.cwd(), "--suite", "")
    return parse(Suite, read_toml(path), path), path


def expand(suite: Suite, path: Path) -> list[Entry]:
    """Every case of a suite, in file order.

    Args:
        suite: as read from `path`; relative paths in it start at the folder of `path`.

    Raises:
        InputError: a scene, environment, mesh or material is missing or invalid, or a run splits
            an error that its truths do not have.
    """
    for number, run in enumerate(suite.run):
        lacks = [t for t in SPLIT if t not in (run.truths or suite.truths)]
        if run.split_model and lacks:
            problem = f"splits what lies between `global` and `physical`; truths has no {lacks[0]}"
            remedy = f"add {', '.join(lacks)} to truths, or leave it out"
            raise InputError(path, f"run.{number}.split_model", problem, remedy)
    entries = [
        Entry(
            case=case,
            truths=run.truths or suite.truths,
            techniques=run.techniques or suite.techniques,
            split_model=run.split_model,
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
    scene_path = find(run.scene, HERE, (".toml",), path.parent, path, f"{field}.scene")
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
        if Path(light).suffix.lower() in (".png", ".jpg", ".jpeg"):
            problem = f"'{light}' holds no linear radiance"
            remedy = f"convert it to {' or '.join(ENVIRONMENT_FORMATS)}"
            raise InputError(path, f"{field}.environments", problem, remedy)
        light_path = find(
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
            _object(o, i, material, changes, scene_path, path, f"{field}.materials")
            for i, o in enumerate(scene.object)
        ]
        try:
            name = file_safe(".".join(parts))
        except ValueError as error:
            problem = f"case {error}".partition("; ")[0]
            raise InputError(path, field, problem, "rename the file") from error
        fields = {
            "id": name,
            "scene": scene_path.stem,
            "environment": Environment(
                name=light_path.stem, path=light_path, rotation=run.rotation
            ),
            "camera": _framed(scene, width, height),
            "width": width,
            "height": height,
            "model": run.model or suite.model,
            "objects": objects,
        }
        cases.append(parse(Case, fields, scene_path))
    return cases


def _framed(scene: Scene, width: int, height: int) -> Camera:
    return widened(scene.camera, scene.resolution[0] / scene.resolution[1], width / height)


def widened(camera: Camera, shape: float, wanted: float) -> Camera:
    """A camera for a picture of another shape (width over height) that cuts nothing off."""
    widening = max(shape / wanted, 1.0)
    if widening == 1.0:
        return camera
    tangent = math.tan(math.radians(camera.fov) / 2) * widening
    return camera.model_copy(update={"fov": 2 * math.degrees(math.atan(tangent))})


def _object(
    entry: SceneObject,
    number: int,
    crossed: str | None,
    changes: dict[str, float],
    scene_path: Path,
    suite_path: Path,
    crossing: str,
) -> Object:
    """One object with its material found, changed and validated.

    Args:
        entry, number: the object as its scene writes it, and where.
        crossed: the material that the suite puts in place of the scene's.
        changes: what the suite sweeps, by axis.
        crossing: the field of the suite that names `crossed`.
    """
    field = f"object.{number}"
    table = {"use": entry.material} if isinstance(entry.material, str) else dict(entry.material)
    if not isinstance(use := table.pop("use", None), str):
        problem = "does not say which material to change"
        raise InputError(scene_path, f"{field}.material", problem, 'add use = "name"')
    home, named_at = scene_path, f"{field}.material"
    if not entry.fixed:
        table |= changes
        if crossed:
            use, home, named_at = crossed, suite_path, crossing
    found = find(use, HERE / "materials", (".toml",), home.parent, home, named_at)
    raw = _with_maps(read_toml(found), found, "")
    table = _with_maps(table, scene_path, f"{field}.material.")
    parse(Material, {**raw, "name": found.stem}, found)  # even a mistake that is overridden
    if "weight" in changes:
        raw.pop("weight_g", None)  # a sweep of the weight moves D and G together
    changed = scene_path if table else None
    material = parse(Material, {**raw, **table, "name": found.stem}, found, changed, field)
    mesh = entry.mesh
    if mesh not in PRIMITIVES:
        shelf, at = HERE / "meshes", f"{field}.mesh"
        home = scene_path.parent
        mesh = str(find(mesh, shelf, MESH_FORMATS, home, scene_path, at, PRIMITIVES))
    fields = entry.model_dump(exclude={"material", "mesh", "fixed"})
    return parse(Object, {**fields, "mesh": mesh, "material": material}, scene_path)


def shelf_materials() -> list[Material]:
    """The materials that come with the project, by name."""
    return [
        parse(Material, {**_with_maps(read_toml(path), path, ""), "name": path.stem}, path)
        for path in sorted((HERE / "materials").glob("*.toml"))
    ]


def _with_maps(table: dict[str, Any], path: Path, at: str) -> dict[str, Any]:
    """A material's table with the pictures of its maps by absolute path."""
    maps = table.get("maps")
    if not isinstance(maps, dict):
        return table  # what it is instead is told by the schema
    shelf = HERE / "textures"
    placed = {
        name: str(find(value, shelf, TEXTURE_FORMATS, path.parent, path, f"{at}maps.{name}"))
        if isinstance(value, str) and value != VERTEX
        else value
        for name, value in maps.items()
    }
    return table | {"maps": placed}
