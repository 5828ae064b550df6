"""Baked geometry on disk, so that a scene is baked once."""

import hashlib
import json
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np

from renderer.transport.tessellation import Tessellation
from renderer.transport.visibility import SEEN, SIDE, Visibility
from scenes.schema import PRIMITIVES, Case, file_digest

VERSION = 3  # raised when the same scene would be baked otherwise


def folder() -> Path:
    """Where bakes are kept: shadeproof/bakes in the user's cache."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "shadeproof" / "bakes"


def key(case: Case) -> str:
    """Names the geometry of a case: its meshes by content, and where they stand."""
    fields = {"mesh", "position", "rotate", "scale", "height"}
    placed = [
        o.model_dump(mode="json", include=fields)
        | {"mesh": o.mesh if o.mesh in PRIMITIVES else file_digest(Path(o.mesh))}
        for o in case.objects
    ]
    text = json.dumps([VERSION, SIDE, SEEN, placed], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


Baked = tuple[list[Tessellation], Visibility]


def baked(name: str, make: Callable[[], Baked]) -> Baked:
    """What is stored under a name; made and stored if it is not there."""
    path = folder() / f"{name}.npz"
    if not path.exists():
        objects, visibility = make()
        arrays = {"open": visibility.open, "clear": visibility.clear, "seen": visibility.seen}
        for k, t in enumerate(objects):
            arrays |= {f"vertices{k}": t.vertices, f"normals{k}": t.normals, f"faces{k}": t.faces}
        path.parent.mkdir(parents=True, exist_ok=True)
        partial = path.with_suffix(f".{os.getpid()}.npz")
        np.savez(partial, **arrays)
        partial.replace(path)
    with np.load(path) as arrays:
        count = sum(name.startswith("faces") for name in arrays.files)
        objects = [
            Tessellation(*(arrays[f"{part}{k}"] for part in ("vertices", "normals", "faces")))
            for k in range(count)
        ]
        return objects, Visibility(arrays["open"], arrays["clear"], arrays["seen"])
