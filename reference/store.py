"""References on disk, each in a folder named by the content that makes it.

    KEY/reference.json          the case's name, the kind, the inputs and the maker
    KEY/background.exr, .json   pixels that no object touches; its ids are 1 where pixels are traced
    KEY/batch-000.exr, .json    one batch each; untraced pixels are 0, which compresses well
    blessed/INPUTS/...          the same, brought by a pack and used whoever made it

KEY is the digest of inputs and maker (see reference.maker), INPUTS that of the inputs alone: what
the picture must be. The batches of a blessed reference come first; this machine adds to them, under
its own KEY and so with seeds of its own.

Nothing is ever changed, only added, each file whole or not at all (see `save_frame`), and the first
to finish batch k keeps it: processes may share a store. Batch k of a KEY is the same picture
whoever makes it on one kind of processor with one variant of Mitsuba, both told by its provenance;
from another (`cuda` for `llvm`) it is an estimate of the same picture from the same seed. Names
that begin with a dot are writes that were cut off: never read, and removed when an hour old.
"""

import datetime
import hashlib
import json
import shutil
import time
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, Literal

import numpy as np

from reference.maker import maker
from reference.settings import PATH, Kind, rounded_samples
from scenes.environment import load_environment
from scenes.errors import InputError
from scenes.frame import Frame, load_frame, save_frame, write_text
from scenes.mesh import load_mesh
from scenes.schema import Case, Material, Model, Object
from scenes.suite import Sampling
from scenes.surface import surface

BLESSED = "blessed"
CUT_OFF = 3600  # seconds after which an unfinished write is nobody's any more
State = Literal["current", "other code", "other packages", "blessed"]


@dataclass(frozen=True)
class Record:
    """One reference of a store, as `Store.records` tells it.

    Attributes:
        model: the switches in which the case's model differs from the paper's; "" for none.
        batches, samples: finished batches, and samples per pixel in all of them.
        size: bytes on disk.
        state: whether this machine's code and packages made it.
    """

    folder: Path
    case: str
    kind: Kind
    model: str
    batches: int
    samples: int
    size: int
    state: State


class Store:
    """A folder of references."""

    def __init__(self, folder: Path) -> None:
        self.folder = Path(folder)

    def path(self, key: str) -> Path:
        """The folder of one reference of our own, whether it exists or not."""
        return self.folder / key

    def blessed(self, case: Case, kind: Kind, sampling: Sampling) -> Path:
        """The folder of the same reference from a pack, whether it exists or not."""
        return self.folder / BLESSED / digest(contents(case, kind, sampling))

    def homes(self, case: Case, kind: Kind, sampling: Sampling) -> list[Path]:
        """The two folders that a reference may have, our own first, whether they exist or not."""
        own = self.path(key(case, kind, sampling))
        return [own, self.blessed(case, kind, sampling)]

    def files(self, case: Case, kind: Kind, sampling: Sampling) -> dict[int, Path]:
        """Finished batches by number: blessed ones, then our own where those have none.

        By their names alone; `load` leaves out what turns out to be damaged.
        """
        homes = self.homes(case, kind, sampling)
        return {_number(p): p for folder in homes for p in _finished(folder)}

    def load(self, case: Case, kind: Kind, sampling: Sampling) -> list[Frame]:
        """The finished batches in order of provenance["batch"]; damaged ones are left out."""
        own, blessed = (_batches(f, case) for f in self.homes(case, kind, sampling))
        batches = own | blessed
        return [batches[number] for number in sorted(batches)]

    def backgrounds(self, case: Case, kind: Kind, sampling: Sampling) -> list[Frame]:
        """What no batch traces, of each folder that has batches; ids are 1 where pixels are."""
        homes = [f for f in self.homes(case, kind, sampling) if _batches(f, case)]
        return [load_frame(folder / "background.exr") for folder in homes]

    def save(
        self,
        case: Case,
        kind: Kind,
        sampling: Sampling,
        number: int,
        frame: Frame,
        traced: np.ndarray,
    ) -> None:
        """Add batch `number`, unless another run has done so by now.

        Args:
            traced: (H, W) bool, where the batches of this reference differ from each other.

        Raises:
            InputError: the folder cannot be written or the disk is full.
        """
        folder = self.path(key(case, kind, sampling))
        if not (folder / "reference.json").is_file():
            record = {"case": case.id, "kind": kind, "inputs": contents(case, kind, sampling)}
            text = json.dumps(record | {"maker": maker()}, indent=1)
            write_text(folder / "reference.json", text)
        if not sound(folder / "background.exr"):
            still = np.where(traced[..., None], 0, frame.rgb)
            save_frame(Frame(still, traced.astype(np.uint8)), folder / "background.exr")
        if sound(path := folder / f"batch-{number:03}.exr"):
            return
        moving = {n: np.where(traced[..., None], layer, 0) for n, layer in frame.layers.items()}
        made = {"code": maker()["code"], "made": datetime.date.today().isoformat()}
        stored = replace(
            frame,
            rgb=np.where(traced[..., None], frame.rgb, 0),
            provenance=frame.provenance | {"batch": number} | made,
            layers=moving,
        )
        save_frame(stored, path)

    def sweep(self) -> None:
        """Remove what writes left behind that were cut off an hour ago or more."""
        for pattern in (".*", "*/.*", f"{BLESSED}/*/.*"):
            for path in self.folder.glob(pattern):
                try:
                    if time.time() - path.stat().st_mtime < CUT_OFF:
                        continue
                    shutil.rmtree(path) if path.is_dir() else path.unlink()
                except OSError:  # another run was faster, or may and we may not
                    continue

    def folders(self) -> list[Path]:
        """The folders of all references, blessed ones last."""
        own = sorted(self.folder.glob("[!.]*/reference.json"))
        return [p.parent for p in own + sorted(self.folder.glob(f"{BLESSED}/[!.]*/reference.json"))]

    def records(self) -> list[Record]:
        """One record per reference; what a folder of ours does not tell is left out."""
        records = []
        for folder in self.folders():
            if (head := read_head(folder)) is None:
                continue
            count, inputs = len(_finished(folder)), head["inputs"]
            blessed = folder.parent.name == BLESSED
            records.append(
                Record(
                    folder=folder,
                    case=head["case"],
                    kind=head["kind"],
                    model=_told(inputs["model"]) if head["kind"] == "model" else "",
                    batches=count,
                    samples=count * inputs["samples_per_batch"],
                    size=sum(f.stat().st_size for f in folder.iterdir()),
                    state="blessed" if blessed else _state(head["maker"]),
                )
            )
        return records

    def damaged(self, folders: Iterable[Path] | None = None) -> list[Path]:
        """Every file that is not what was written: EXRs by their digest, heads by their folder.

        Args:
            folders: of the references to look at, whether they exist or not; all if None.
        """
        found = []
        for folder in self.folders() if folders is None else folders:
            if not any(folder.glob("[!.]*")):
                continue
            head = read_head(folder)
            blessed = folder.parent.name == BLESSED
            if head is None or folder.name != _name(head, blessed):
                found.append(folder / "reference.json")
            frames = {p.with_suffix(".exr") for p in folder.glob("batch-*")}
            frames |= {folder / "background.exr"} if frames else set()
            found += sorted(p for p in frames if not (sound(p) or _unfinished(p)))
        return found


def mending(path: Path) -> str:
    """What to do about a damaged file of a store."""
    batch = path.stem.startswith("batch-")
    what = "delete it and the .json beside it" if batch else "delete its folder"
    blessed = path.parent.parent.name == BLESSED
    return f"{what}, and " + ("unpack its pack again" if blessed else "trace it again")


def _number(path: Path) -> int:
    return int(path.stem.removeprefix("batch-"))


def _finished(folder: Path) -> list[Path]:
    """The batches of a folder that have their JSON, in order."""
    found = (p for p in folder.glob("batch-*.exr") if p.with_suffix(".json").is_file())
    return sorted(found, key=_number)


def sound(path: Path) -> bool:
    """Whether a picture is finished and as it was written."""
    return load_sound(path) is not None


def _unfinished(path: Path) -> bool:
    """Whether a picture never got its JSON: its run was killed, and the next one makes it anew."""
    return path.is_file() and not path.with_suffix(".json").is_file()


def _batches(folder: Path, case: Case) -> dict[int, Frame]:
    """The sound batches of a folder by number."""
    background = load_sound(folder / "background.exr")
    if background is None or background.rgb.shape[:2] != (case.height, case.width):
        return {}
    return {
        _number(path): _over(background, frame)
        for path in _finished(folder)
        if (frame := load_sound(path)) is not None and frame.rgb.shape == background.rgb.shape
    }


def read_head(folder: Path) -> dict[str, Any] | None:
    """A folder's reference.json, or None where it is not one of ours."""
    try:
        head = json.loads((folder / "reference.json").read_text())
        complete = all(isinstance(head[name], str) for name in ("case", "kind"))
        complete &= all(isinstance(head[name], dict) for name in ("maker", "inputs"))
        complete &= "samples_per_batch" in head["inputs"]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return head if complete else None


def _name(head: dict[str, Any], blessed: bool) -> str:
    """The name that a reference's folder must have."""
    inputs = head["inputs"]
    return digest(inputs) if blessed else digest({"inputs": inputs, "maker": head["maker"]})


def _state(made_by: dict[str, str]) -> State:
    if made_by == maker():
        return "current"
    return "other code" if made_by.get("code") != maker()["code"] else "other packages"


def _told(model: dict[str, Any]) -> str:
    """The switches of a model that are not the paper's."""
    paper = Model().model_dump()
    return ", ".join(f"{k} {v}" for k, v in model.items() if v != paper.get(k))


def _over(background: Frame, batch: Frame) -> Frame:
    """A batch with the background where nothing is traced; layers off one lobe have none."""
    still = background.ids[..., None] == 0

    def filled(picture: np.ndarray) -> np.ndarray:
        return np.where(still, background.rgb, picture)

    layers = {n: p if "." in n else filled(p) for n, p in batch.layers.items()}
    return replace(batch, rgb=filled(batch.rgb), layers=layers)


def load_sound(path: Path) -> Frame | None:
    """A finished frame, or None: without its JSON (written last) a frame has no ids."""
    try:
        frame = load_frame(path)
    except InputError:
        return None
    return frame if frame.ids is not None else None


def key(case: Case, kind: Kind, sampling: Sampling) -> str:
    """The digest of all that makes the picture; the number of batches is no part of it."""
    return digest({"inputs": contents(case, kind, sampling), "maker": maker()})


def digest(content: dict[str, Any]) -> str:
    """SHA-256 (hex) of what JSON can hold, whatever its order."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def contents(case: Case, kind: Kind, sampling: Sampling) -> dict[str, Any]:
    """The inputs: what the picture must be, in values and digests, no names or paths.

    Meshes and environments are digested as the arrays that are drawn, so that a library which
    decodes a file otherwise, or computes other normals, gives other inputs. How it is sampled is
    the maker's affair, but for the samples in a batch.

    Raises:
        InputError: a mesh or an environment cannot be used.
    """
    return {
        "kind": kind,
        "model": case.model.model_dump() if kind == "model" else None,
        "camera": case.camera.model_dump(),
        "size": [case.width, case.height],
        "environment": {
            "sha256": _environment_digest(Path(case.environment.path)),
            "rotation": case.environment.rotation,
        },
        "objects": [_object(o, kind, case.model) for o in case.objects],
        "integrator": PATH,
        "samples_per_batch": rounded_samples(sampling.samples_per_batch),
    }


@cache
def _environment_digest(path: Path) -> str:
    return _arrays_digest(load_environment(path).radiance)


@cache
def _mesh_digest(mesh: str) -> str:
    made = load_mesh(mesh)
    return _arrays_digest(made.vertices, made.normals, made.faces)


def _arrays_digest(*arrays: np.ndarray) -> str:
    """SHA-256 (hex) of arrays, their shapes and types, on any machine."""
    found = hashlib.sha256()
    for array in arrays:
        little = np.ascontiguousarray(array, array.dtype.newbyteorder("<"))
        found.update(f"{little.dtype.str} {little.shape}\n".encode())
        found.update(little.data)
    return found.hexdigest()


def _object(obj: Object, kind: Kind, model: Model) -> dict[str, Any]:
    content = {
        "mesh": _mesh_digest(obj.mesh),
        "placement": obj.model_dump(include={"position", "rotate", "scale", "height"}),
        "material": _optics(obj.material, kind, model),
    }
    return content | ({"varies": _varying(obj)} if obj.material.varies else {})


def _varying(obj: Object) -> dict[str, Any]:
    """What a material with a direction or maps adds to its numbers."""
    found, material = surface(obj), obj.material
    return {
        "stretch": material.stretch,
        "rotation": material.rotation,
        "albedo": material.albedo,
        "metallic": material.metallic,
        "f0": [o.f0 if o else None for o in (material.f0, material.metal)],
        "follows": material.weight_g is None,
        "maps": {n: _arrays_digest(a) for n, a in found.textures.items()},
        "vertices": {n: _arrays_digest(a) for n, a in found.carried.items()},
    }


def _optics(material: Material, kind: Kind, model: Model) -> dict[str, Any]:
    """The numbers that the reference's BSDF is made of."""
    surface = {"alpha": material.alpha, "weight": material.weight}
    if kind == "model":
        surface["weight_g"] = material.masking_weight
    if kind == "physical" or model.fresnel == "exact":
        return surface | {
            "albedo": material.albedo,
            "metallic": material.metallic,
            "eta": material.f0.eta,
            "metal": (material.metal.eta, material.metal.k) if material.metal else None,
        }
    if kind == "model" and model.fresnel == "f82":
        surface["f82"] = material.specular_f82
    return surface | {"albedo": material.diffuse_albedo, "f0": material.specular_f0}
