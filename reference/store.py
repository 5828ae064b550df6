"""References on disk, each in a folder named by the content that makes it.

    KEY/reference.json          the case, the truth, and everything that went into the key
    KEY/background.exr, .json   pixels that no object touches; its ids are 1 where pixels are traced
    KEY/batch-000.exr, .json    one batch each; untraced pixels are 0, which compresses well

Nothing is ever changed, only added, each file whole or not at all (see `save_frame`), and batch k
of a key is the same picture whoever makes it: processes may share a store.
"""

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np

from reference.settings import PATH, SAMPLER, rounded_samples
from scenes.errors import InputError
from scenes.frame import Frame, load_frame, save_frame, write_text
from scenes.schema import PRIMITIVES, Case, Material, Model, Object, file_digest
from scenes.suite import Sampling, Truth

HERE = Path(__file__).resolve().parent
# What turns the inputs into a picture; a change in any of these is another reference.
SOURCES = ("mixture.py", "physical.py", "scene_dict.py", "truths.py", "settings.py")
SOURCES += ("../scenes/mesh.py", "../scenes/environment.py")


class Store:
    """A folder of references."""

    def __init__(self, folder: Path) -> None:
        self.folder = Path(folder)

    def path(self, key: str) -> Path:
        """The folder of one reference, whether it exists or not."""
        return self.folder / key

    def load(self, case: Case, truth: Truth, sampling: Sampling) -> list[Frame]:
        """The finished batches in order of provenance["batch"]; damaged ones are left out."""
        folder = self.path(key(case, truth, sampling))
        background = _load(folder / "background.exr")
        if background is None or background.rgb.shape[:2] != (case.height, case.width):
            return []
        traced = background.ids[..., None] > 0
        return [
            Frame(np.where(traced, f.rgb, background.rgb), f.ids, f.seconds, f.provenance)
            for path in sorted(folder.glob("batch-*.exr"))
            if (f := _load(path)) is not None and f.rgb.shape == background.rgb.shape
        ]

    def save(
        self,
        case: Case,
        truth: Truth,
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
        content = contents(case, truth, sampling)
        folder = self.path(_digest(content))
        if not (folder / "reference.json").is_file():
            record = {"case": case.id, "truth": truth, "inputs": content}
            write_text(folder / "reference.json", json.dumps(record, indent=1))
        if _load(folder / "background.exr") is None:
            still = np.where(traced[..., None], 0, frame.rgb)
            save_frame(Frame(still, traced.astype(np.uint8)), folder / "background.exr")
        moving = np.where(traced[..., None], frame.rgb, 0)
        stored = Frame(moving, frame.ids, frame.seconds, frame.provenance | {"batch": number})
        save_frame(stored, folder / f"batch-{number:03}.exr")

    def list(self) -> list[dict[str, Any]]:
        """One record per reference: key, case, truth, finished batches, samples in all, bytes."""
        records = []
        for path in sorted(self.folder.glob("*/reference.json")):
            head = json.loads(path.read_text())
            batches = len(list(path.parent.glob("batch-*.json")))
            records.append(
                {
                    "key": path.parent.name,
                    "case": head["case"],
                    "truth": head["truth"],
                    "batches": batches,
                    "samples": batches * head["inputs"]["samples_per_batch"],
                    "bytes": sum(f.stat().st_size for f in path.parent.iterdir()),
                }
            )
        return records


def _load(path: Path) -> Frame | None:
    """A finished frame, or None: without its JSON (written last) a frame has no ids."""
    try:
        frame = load_frame(path)
    except InputError:
        return None
    return frame if frame.ids is not None else None


def key(case: Case, truth: Truth, sampling: Sampling) -> str:
    """SHA-256 (hex) of all that makes the picture; the number of batches is no part of it."""
    return _digest(contents(case, truth, sampling))


def _digest(content: dict[str, Any]) -> str:
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def contents(case: Case, truth: Truth, sampling: Sampling) -> dict[str, Any]:
    """What goes into the key: values and digests, no names, paths or descriptions.

    Versions of packages are no part of it; the frames record them.
    """
    return {
        "truth": truth,
        "model": case.model.model_dump() if truth != "physical" else None,
        "camera": case.camera.model_dump(),
        "size": [case.width, case.height],
        "environment": {
            "sha256": file_digest(case.environment.path),
            "rotation": case.environment.rotation,
        },
        "objects": [_object(o, truth, case.model) for o in case.objects],
        "integrator": PATH if truth != "unoccluded" else None,
        "sampler": SAMPLER,
        "samples_per_batch": rounded_samples(sampling.samples_per_batch),
        # Read as text: line ends may differ between machines.
        "sources": {
            name: hashlib.sha256((HERE / name).read_text(encoding="utf-8").encode()).hexdigest()
            for name in SOURCES
        },
    }


def _object(obj: Object, truth: Truth, model: Model) -> dict[str, Any]:
    return {
        "mesh": obj.mesh if obj.mesh in PRIMITIVES else file_digest(Path(obj.mesh)),
        "placement": obj.model_dump(include={"position", "rotate", "scale", "height"}),
        "material": _optics(obj.material, truth, model),
    }


def _optics(material: Material, truth: Truth, model: Model) -> dict[str, Any]:
    """The numbers that the truth's BSDF is made of."""
    surface = {"alpha": material.alpha, "weight": material.weight}
    if truth != "physical":
        surface["weight_g"] = material.masking_weight
    if truth == "physical" or model.fresnel == "exact":
        return surface | {
            "albedo": material.albedo,
            "metallic": material.metallic,
            "eta": material.f0.eta,
            "metal": (material.metal.eta, material.metal.k) if material.metal else None,
        }
    return surface | {"albedo": material.diffuse_albedo, "f0": material.specular_f0}
