"""References on disk, each in a folder named by the content that makes it.

    KEY/reference.json          the case, the truth, and everything that went into the key
    KEY/background.exr, .json   pixels that no object touches; its ids are 1 where pixels are traced
    KEY/batch-000.exr, .json    one batch each; untraced pixels are 0, which compresses well

Nothing is ever changed, only added, each file whole or not at all (see `save_frame`), and batch k
of a key is the same picture whoever makes it: processes may share a store.
"""

import hashlib
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from reference.settings import (
    PATH,
    PILOT_SAMPLES,
    PILOT_SEED,
    SAMPLER,
    SPLIT,
    Kind,
    rounded_samples,
)
from scenes.errors import InputError
from scenes.frame import Frame, load_frame, save_frame, write_text
from scenes.schema import PRIMITIVES, Case, Material, Model, Object, file_digest
from scenes.suite import Sampling

HERE = Path(__file__).resolve().parent
# What turns the inputs into a picture; a change in any of these is another reference.
SOURCES = ("mixture.py", "physical.py", "scene_dict.py", "truths.py", "transport.py", "settings.py")
SOURCES += ("../scenes/mesh.py", "../scenes/environment.py")


class Store:
    """A folder of references."""

    def __init__(self, folder: Path) -> None:
        self.folder = Path(folder)

    def path(self, key: str) -> Path:
        """The folder of one reference, whether it exists or not."""
        return self.folder / key

    def load(self, case: Case, kind: Kind, sampling: Sampling) -> list[Frame]:
        """The finished batches in order of provenance["batch"]; damaged ones are left out."""
        folder = self.path(key(case, kind, sampling))
        background = _load(folder / "background.exr")
        if background is None or background.rgb.shape[:2] != (case.height, case.width):
            return []
        return [
            _over(background, f)
            for path in sorted(folder.glob("batch-*.exr"))
            if (f := _load(path)) is not None and f.rgb.shape == background.rgb.shape
        ]

    def save(
        self,
        case: Case,
        kind: Kind,
        sampling: Sampling,
        number: int,
        frame: Frame,
        traced: np.ndarray,
    ) -> None:
        """Add batch `number`.

        Args:
            traced: (H, W) bool, where the batches of this reference differ from each other.

        Raises:
            InputError: the folder cannot be written or the disk is full.
        """
        content = contents(case, kind, sampling)
        folder = self.path(_digest(content))
        if not (folder / "reference.json").is_file():
            record = {"case": case.id, "kind": kind, "inputs": content}
            write_text(folder / "reference.json", json.dumps(record, indent=1))
        if _load(folder / "background.exr") is None:
            still = np.where(traced[..., None], 0, frame.rgb)
            save_frame(Frame(still, traced.astype(np.uint8)), folder / "background.exr")
        moving = {n: np.where(traced[..., None], layer, 0) for n, layer in frame.layers.items()}
        stored = replace(
            frame,
            rgb=np.where(traced[..., None], frame.rgb, 0),
            provenance=frame.provenance | {"batch": number},
            layers=moving,
        )
        save_frame(stored, folder / f"batch-{number:03}.exr")

    def list(self) -> list[dict[str, Any]]:
        """One record per reference: key, case, kind, finished batches, samples in all, bytes."""
        records = []
        for path in sorted(self.folder.glob("*/reference.json")):
            head = json.loads(path.read_text())
            batches = len(list(path.parent.glob("batch-*.json")))
            records.append(
                {
                    "key": path.parent.name,
                    "case": head["case"],
                    "kind": head["kind"],
                    "batches": batches,
                    "samples": batches * head["inputs"]["samples_per_batch"],
                    "bytes": sum(f.stat().st_size for f in path.parent.iterdir()),
                }
            )
        return records


def _over(background: Frame, batch: Frame) -> Frame:
    """A batch with the background where nothing is traced; layers off one lobe have none."""
    still = background.ids[..., None] == 0

    def filled(picture: np.ndarray) -> np.ndarray:
        return np.where(still, background.rgb, picture)

    layers = {n: p if "." in n else filled(p) for n, p in batch.layers.items()}
    return replace(batch, rgb=filled(batch.rgb), layers=layers)


def _load(path: Path) -> Frame | None:
    """A finished frame, or None: without its JSON (written last) a frame has no ids."""
    try:
        frame = load_frame(path)
    except InputError:
        return None
    return frame if frame.ids is not None else None


def key(case: Case, kind: Kind, sampling: Sampling) -> str:
    """SHA-256 (hex) of all that makes the picture; the number of batches is no part of it."""
    return _digest(contents(case, kind, sampling))


def _digest(content: dict[str, Any]) -> str:
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def contents(case: Case, kind: Kind, sampling: Sampling) -> dict[str, Any]:
    """What goes into the key: values and digests, no names, paths or descriptions.

    Versions of packages are no part of it; the frames record them.
    """
    return {
        "kind": kind,
        "model": case.model.model_dump() if kind == "model" else None,
        "camera": case.camera.model_dump(),
        "size": [case.width, case.height],
        "environment": {
            "sha256": file_digest(case.environment.path),
            "rotation": case.environment.rotation,
        },
        "objects": [_object(o, kind, case.model) for o in case.objects],
        "integrator": PATH,
        "sampler": [SAMPLER, SPLIT, PILOT_SAMPLES, PILOT_SEED],
        "samples_per_batch": rounded_samples(sampling.samples_per_batch),
        # Read as text: line ends may differ between machines.
        "sources": {
            name: hashlib.sha256((HERE / name).read_text(encoding="utf-8").encode()).hexdigest()
            for name in SOURCES
        },
    }


def _object(obj: Object, kind: Kind, model: Model) -> dict[str, Any]:
    return {
        "mesh": obj.mesh if obj.mesh in PRIMITIVES else file_digest(Path(obj.mesh)),
        "placement": obj.model_dump(include={"position", "rotate", "scale", "height"}),
        "material": _optics(obj.material, kind, model),
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
    return surface | {"albedo": material.diffuse_albedo, "f0": material.specular_f0}
