"""References that travel: one file that holds all a suite needs, known by its digest.

A pack is a zip of stored (not compressed) members with sorted names and fixed times, so that the
same references give the same bytes:

    INPUTS/reference.json, background.exr, batch-000.exr, ...   folders as in the store's `blessed`
    manifest.json    schema, suite, date, references, and the SHA-256 of every other member
"""

import errno
import hashlib
import json
import os
import re
import reprlib
import secrets
import shutil
import struct
import zipfile
import zlib
from collections.abc import Iterable
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, ValidationError

from reference.batches import missing
from reference.settings import FEWEST_BATCHES, Kind
from reference.store import BLESSED, Store, contents, digest, load_sound, read_head, sound
from scenes.errors import InputError
from scenes.files import checked_file
from scenes.frame import sha256, unwritable, written_aside
from scenes.schema import Case
from scenes.suite import Sampling
from scenes.words import first_mistake

SCHEMA = 1
MANIFEST = "manifest.json"
MEMBER = re.compile(r"[0-9a-f]{64}/(reference\.json|(background|batch-\d{3,9})\.(exr|json))")
EPOCH = (1980, 1, 1, 0, 0, 0)  # the first time a zip can hold
UNSOUND = "is no sound pack (damaged, or no pack)"
AGAIN = "fetch or make the pack again"
DAMAGE = (  # what the readers of zip, JSON and EXR raise on spoilt bytes
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    ValueError,
    TypeError,
    LookupError,
    EOFError,
    RuntimeError,  # of a compression unknown to zipfile, too
    OverflowError,
)
Digest = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]


class Packed(BaseModel):
    """One reference of a pack; `inputs` names its folder."""

    model_config = ConfigDict(extra="forbid", strict=True)

    case: str
    kind: Kind
    inputs: Digest
    maker: dict[str, str]
    batches: int = Field(ge=FEWEST_BATCHES)
    samples: int


class Manifest(BaseModel):
    """What a pack holds; `files` by the SHA-256 (hex) of each."""

    model_config = ConfigDict(extra="forbid", strict=True)

    version: Literal[1] = Field(alias="schema")
    suite: str
    date: str
    references: list[Packed] = Field(min_length=1)
    files: dict[str, Digest]


def pack(
    wanted: Iterable[tuple[Case, Kind, Sampling]], store: Store, path: Path, suite: str
) -> tuple[str, dict[str, Any]]:
    """Write every sound batch of some references into one file.

    Args:
        wanted: each must have at least 8 batches in the store.
        suite: its name, for the manifest.

    Returns:
        The file's SHA-256 (hex), and the manifest.

    Raises:
        InputError: a reference is missing, or the file cannot be written.
    """
    members: dict[str, Path] = {}
    references, dates = [], []
    for case, kind, sampling in wanted:
        name = digest(contents(case, kind, sampling))
        batches, background, head = _sources(case, kind, sampling, store)
        if len(batches) < FEWEST_BATCHES:
            raise missing(case, kind, sampling, len(batches), store)
        for picture in (background, *batches):
            members[f"{name}/{picture.name}"] = picture
            members[f"{name}/{picture.stem}.json"] = picture.with_suffix(".json")
        members[f"{name}/reference.json"] = head
        records = [json.loads(p.with_suffix(".json").read_text())["provenance"] for p in batches]
        dates.append(max(r["made"] for r in records))
        references.append(
            {
                "case": case.id,
                "kind": kind,
                "inputs": name,
                "maker": json.loads(head.read_text())["maker"],
                "batches": len(batches),
                "samples": sum(r["samples"] for r in records),
            }
        )
    manifest = {
        "schema": SCHEMA,
        "suite": suite,
        "date": max(dates),
        "references": references,
        "files": {name: sha256(source) for name, source in sorted(members.items())},
    }
    with written_aside(path) as aside:
        with zipfile.ZipFile(aside, "w", zipfile.ZIP_STORED) as file:
            for name, source in sorted(members.items()):
                file.writestr(zipfile.ZipInfo(name, EPOCH), source.read_bytes())
            text = json.dumps(manifest, indent=1)
            file.writestr(zipfile.ZipInfo(MANIFEST, EPOCH), text)
        whole = sha256(aside)
    return whole, manifest


def _sources(
    case: Case, kind: Kind, sampling: Sampling, store: Store
) -> tuple[list[Path], Path, Path]:
    """The sound batches of a reference, its background and its head.

    From two folders only where they share the background: a batch holds nothing there.
    """
    found = store.files(case, kind, sampling)
    batches = [found[number] for number in sorted(found) if sound(found[number])]
    if not batches:
        return [], Path(), Path()
    first = batches[0].parent
    background = first / "background.exr"
    if not sound(background):
        return [], Path(), Path()
    still = {p: sha256(p / "background.exr") for p in {b.parent for b in batches}}
    kept = [b for b in batches if still[b.parent] == still[first]]
    return kept, background, first / "reference.json"


def unpack(path: Path, store: Store, expected: str = "") -> dict[str, Any]:
    """Bless the references of a pack: put them in a store, all or none.

    Each must be whole, with at least 8 batches, before it takes the place of an earlier one.

    Args:
        expected: SHA-256 (hex) that the file must have; any if empty.

    Returns:
        The manifest.

    Raises:
        InputError: it is not that file, it is damaged or no pack, or the store cannot be written.
    """
    try:
        actual = sha256(checked_file(path))
    except OSError as error:
        problem = f"cannot be read ({error.strerror})"
        raise InputError(path, "", problem, "check the path") from error
    if expected and actual != expected.strip().lower().removeprefix("sha256:"):
        problem = f"has the SHA-256 {actual}, not {expected}"
        raise InputError(path, "--digest", problem, AGAIN)
    with _aside(store) as aside, _complaints(path), zipfile.ZipFile(path) as file:
        manifest = _manifest(file, path.stat().st_size)
        for name, wanted in manifest["files"].items():
            target = aside / name
            target.parent.mkdir(exist_ok=True)
            _copy(file, name, target, wanted)
        counts = {folder.name: _batches(folder) for folder in sorted(aside.iterdir())}
        if counts != {r["inputs"]: r["batches"] for r in manifest["references"]}:
            raise UnsoundError("its references are not those of the manifest")
        (store.folder / BLESSED).mkdir(exist_ok=True)
        for folder in sorted(aside.iterdir()):
            _settle(folder, store.folder / BLESSED / folder.name)
    return manifest


@contextmanager
def _aside(store: Store):
    """A hidden folder in the store, gone afterwards; trouble with writing becomes one line."""
    aside = store.folder / f".{secrets.token_hex(4)}-unpack"
    fresh = [f for f in (store.folder, *store.folder.parents) if not f.exists()]
    try:
        aside.mkdir(parents=True)
        yield aside
    except OSError as error:
        raise unwritable("--store", str(store.folder), error) from error
    finally:
        shutil.rmtree(aside, ignore_errors=True)
        for folder in fresh:
            with suppress(OSError):  # it holds what was unpacked
                folder.rmdir()


class UnsoundError(Exception):
    """What is wrong inside a pack, in our own words."""


@contextmanager
def _complaints(path: Path):
    """Whatever is wrong inside a pack becomes one line."""
    try:
        yield
    except OSError as error:
        if error.errno != errno.EINVAL:  # that is a place in the file that cannot be
            raise
        raise InputError(path, "", UNSOUND, AGAIN) from error
    except UnsoundError as error:
        raise InputError(path, "", f"is no sound pack ({error})", AGAIN) from error
    except DAMAGE as error:
        raise InputError(path, "", UNSOUND, AGAIN) from error


def _manifest(file: zipfile.ZipFile, size: int) -> dict[str, Any]:
    """The manifest, after the members' names, sizes and kinds have been held against it.

    Args:
        size: bytes of the whole file: nothing in it is compressed, so it holds no more.
    """
    infos = {info.filename: info for info in file.infolist()}
    for name, info in infos.items():
        if name != MANIFEST and not MEMBER.fullmatch(name):
            raise UnsoundError(f"{reprlib.repr(name)} has no place in a store")
        if info.compress_type != zipfile.ZIP_STORED:
            raise UnsoundError(f"{name} is compressed")
    if MANIFEST not in infos:
        raise UnsoundError("it has no manifest")
    if sum(info.file_size for info in infos.values()) > size:
        raise UnsoundError("its members claim more than the file holds")
    manifest = json.loads(file.read(MANIFEST))
    try:
        Manifest.model_validate(manifest)
    except ValidationError as error:
        field, problem, _ = first_mistake(error)
        raise UnsoundError(f"{MANIFEST}: {f'{field} {problem}'.strip()}") from error
    if len(infos) != len(file.infolist()) or set(infos) != {*manifest["files"], MANIFEST}:
        raise UnsoundError("its members are not those of the manifest")
    return manifest


def _copy(file: zipfile.ZipFile, name: str, target: Path, wanted: str) -> None:
    found = hashlib.sha256()
    with file.open(name) as source, target.open("wb") as copy:
        while block := source.read(1 << 20):
            found.update(block)
            copy.write(block)
    if found.hexdigest() != wanted:
        raise UnsoundError(f"{name} is damaged")


def _batches(folder: Path) -> int:
    """How many batches an unpacked reference holds.

    Raises:
        UnsoundError: it is not whole, a number or a seed comes twice, or it has fewer than 8.
    """
    head = read_head(folder)
    if head is None or digest(head["inputs"]) != folder.name:
        raise UnsoundError(f"{folder.name}/reference.json names other inputs")
    background = load_sound(folder / "background.exr")
    if background is None:
        raise UnsoundError(f"{folder.name}/background.exr is missing or not sound")
    numbers, seeds = set(), set()
    pictures = sorted({p.with_suffix(".exr") for p in folder.glob("batch-*")})
    for path in pictures:
        frame, name = load_sound(path), f"{folder.name}/{path.name}"
        if frame is None or frame.rgb.shape != background.rgb.shape:
            raise UnsoundError(f"{name} is not sound")
        number, seed = frame.provenance["batch"], frame.provenance["seed"]
        if path.stem != f"batch-{number:03}":
            raise UnsoundError(f"{name} says that it is batch {number}")
        if number in numbers or seed in seeds:
            raise UnsoundError(f"{name} has the number or the seed of another batch")
        numbers.add(number)
        seeds.add(seed)
    if len(pictures) < FEWEST_BATCHES:
        raise UnsoundError(
            f"{folder.name} has {len(pictures)} batches, fewer than {FEWEST_BATCHES}"
        )
    return len(pictures)


def _settle(folder: Path, target: Path) -> None:
    """Move a whole folder to its place, in the stead of what an earlier pack left there."""
    old = target.with_name(f".{secrets.token_hex(4)}-old")
    if target.exists():
        os.replace(target, old)
    os.replace(folder, target)
    shutil.rmtree(old, ignore_errors=True)
