"""References from outside: one's own batches, as EXRs in a folder."""

import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import get_args

import numpy as np

from scenes.camera import seen_objects
from scenes.environment import read_pixels
from scenes.errors import InputError
from scenes.frame import Frame
from scenes.schema import Case
from scenes.suite import Entry, Truth

OWN = "global"  # the truth that EXRs in a case's folder itself stand for
NAMES = get_args(Truth)


def restricted(entry: Entry, folder: Path) -> Entry:
    """An entry with those of its truths that a folder holds.

    Raises:
        InputError: it holds none of them, or a folder that is none.
    """
    for path in sorted((folder / entry.case.id).glob("*/")):
        if path.name not in NAMES:
            remedy = f"call it one of {', '.join(NAMES)}"
            raise InputError("--truth", str(path), "is named like no truth", remedy)
    there = tuple(t for t in entry.truths if own_files(folder, entry.case, t))
    if not there:
        problem = f"holds no batch of {', '.join(entry.truths)} of {entry.case.id}"
        remedy = f"put EXRs into {entry.case.id} (for `{OWN}`), or {entry.case.id}/<truth>"
        raise InputError("--truth", str(folder), problem, remedy)
    return entry.model_copy(update={"truths": there, "split_model": False})


def check_batches(folder: Path, entry: Entry) -> None:
    """See that all batches of an entry can be used, before a candidate draws for them.

    Raises:
        InputError: as `own_batches`.
    """
    for truth in entry.truths:
        for _ in _pictures(folder, entry.case, truth):
            pass


def own_batches(folder: Path, case: Case, truth: str) -> list[Frame]:
    """The batches of a truth of a case: each EXR is one, independent of the others.

    What object a pixel shows our own geometry tells, since the pictures do not.

    Raises:
        InputError: a file is no picture of the case's size, a value in it is no light, or two
            files are the same and so not independent.
    """
    ids = seen_objects(case)
    return [
        Frame(rgb, ids, 0.0, {"samples": 0, "truth": truth, "file": str(path)})
        for path, rgb in _pictures(folder, case, truth)
    ]


def _pictures(folder: Path, case: Case, truth: str) -> Iterator[tuple[Path, np.ndarray]]:
    digests: dict[str, Path] = {}
    for path in own_files(folder, case, truth):
        rgb = read_pixels(path, "reference", (case.width, case.height))
        if bad := int((~(np.isfinite(rgb) & (rgb >= 0))).any(axis=2).sum()):
            problem = f"holds NaN, Inf or light below zero in {bad} pixels"
            raise InputError(path, "reference", problem, "write linear radiance")
        same = digests.setdefault(hashlib.sha256(rgb.tobytes()).hexdigest(), path)
        if same != path:
            problem = f"holds the same picture as {same.name}"
            raise InputError(path, "reference", problem, "trace each batch with a seed of its own")
        yield path, rgb


def own_files(folder: Path, case: Case, truth: str) -> list[Path]:
    """The EXRs of a truth of a case, in order; none if the folder has no such truth."""
    own = folder / case.id
    found = sorted((own / truth).glob("*.exr"))
    return found or (sorted(own.glob("*.exr")) if truth == OWN else [])
