"""Baked geometry on disk, so that a scene is baked once."""

import hashlib
import json
import os
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from pathlib import Path

import numpy as np

from renderer.transport.tessellation import Tessellation
from renderer.transport.visibility import SEEN, SIDE, Visibility
from scenes.schema import PRIMITIVES, Case, file_digest
from scenes.surface import surface

MOST_BYTES = 4 << 30  # beyond it the bakes that were longest not used go
VERSION = 7  # raised when the same scene would be baked otherwise


def folder() -> Path:
    """Where bakes are kept: shadeproof/bakes in the user's cache."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "shadeproof" / "bakes"


@dataclass(frozen=True)
class Placement:
    """A case by its geometry alone: equal to any other that is placed and baked alike."""

    key: str
    case: Case = field(compare=False)


def placement(case: Case) -> Placement:
    """Keys the geometry of a case: its meshes by content, and where they stand."""
    placing = {"mesh", "position", "rotate", "scale", "height"}
    placed = [
        o.model_dump(mode="json", include=placing)
        | {"mesh": o.mesh if o.mesh in PRIMITIVES else file_digest(Path(o.mesh))}
        for o in case.objects
    ]
    # Materials count only by what their vertices carry.
    carrying = [
        {name: hashlib.sha256(a.tobytes()).hexdigest() for name, a in surface(o).carried.items()}
        for o in case.objects
    ]
    extra = [carrying] if any(carrying) else []
    text = json.dumps([VERSION, SIDE, SEEN, placed, *extra], sort_keys=True)
    return Placement(hashlib.sha256(text.encode()).hexdigest(), case)


Baked = tuple[list[Tessellation], Visibility]


def baked(name: str, make: Callable[[], Baked]) -> Baked:
    """What is stored under a name; made and stored if it is not there, or damaged."""
    path = folder() / f"{name}.npz"
    try:
        return _read(path)
    except (OSError, ValueError, KeyError, zipfile.BadZipFile):
        objects, visibility = make()
    arrays = vars(visibility) | {"seeing": np.packbits(visibility.seeing, axis=1)}
    for k, of_one in enumerate(objects):
        arrays |= {f"{part}{k}": array for part, array in vars(of_one).items()}
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(f".{os.getpid()}.npz")
    np.savez(partial, **arrays)
    partial.replace(path)
    _make_room(path)
    return objects, visibility


def _make_room(newest: Path) -> None:
    """Drop what was longest not read, but never the newest."""
    others = [p for p in newest.parent.glob("*.npz") if p != newest]
    kept = newest.stat().st_size
    for path in sorted(others, key=lambda p: p.stat().st_mtime, reverse=True):
        kept += path.stat().st_size
        if kept > MOST_BYTES:
            path.unlink(missing_ok=True)


def _read(path: Path) -> Baked:
    with np.load(path) as arrays:
        count = sum(name.startswith("faces") for name in arrays.files)
        parts = [of.name for of in fields(Tessellation)]
        objects = [Tessellation(*(arrays[f"{part}{k}"] for part in parts)) for k in range(count)]
        held = {of.name: arrays[of.name] for of in fields(Visibility)}
    path.touch()
    return objects, Visibility(**held | {"seeing": np.unpackbits(held["seeing"], axis=1) > 0})
