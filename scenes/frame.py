"""Frame: one answer to a case, in memory and on disk as EXR plus JSON."""

import errno
import hashlib
import json
import math
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio

from scenes.environment import read_pixels
from scenes.errors import InputError


@dataclass(frozen=True, eq=False)
class Frame:
    """One picture of a case.

    Attributes:
        rgb: (H, W, 3) float32, linear radiance, row 0 on top.
        ids: (H, W) uint8, the object seen at the pixel's centre (1-based as in Case.index),
            0 for the background; None where the maker cannot tell.
        layers: further pictures of the same size, (H, W, 3) float32 by name.
        seconds: time spent on the picture itself, without set-up.
        provenance: versions, device, seed, samples and other times, ready for JSON.
    """

    rgb: np.ndarray
    ids: np.ndarray | None = None
    seconds: float = float("nan")
    provenance: dict[str, Any] = field(default_factory=dict)
    layers: dict[str, np.ndarray] = field(default_factory=dict)


def save_frame(frame: Frame, path: Path) -> None:
    """Write `path` (.exr, float32, lossless) and its .json beside it; each appears whole or not.

    Layers are the channels "<name>.R" and so on.

    The JSON is written last and holds the picture's SHA-256: a frame is finished where the two
    agree, so that whoever is killed between them, or damages one of them, leaves none.

    Raises:
        InputError: the folder cannot be written or the disk is full.
    """
    seconds = None if math.isnan(frame.seconds) else frame.seconds  # JSON has no NaN
    record = {"seconds": seconds, "provenance": frame.provenance}
    record |= {"has_ids": frame.ids is not None, "layers": list(frame.layers)}
    channels, names = [frame.rgb.astype(np.float32)], ["R", "G", "B"]
    if frame.ids is not None:
        channels.append(frame.ids[..., None].astype(np.float32))
        names.append("id")
    for name, layer in frame.layers.items():
        channels.append(layer.astype(np.float32))
        names += [f"{name}.{c}" for c in "RGB"]
    pixels = np.ascontiguousarray(np.concatenate(channels, axis=2))
    with written_aside(path) as aside:
        write_exr(aside, pixels, names)
        record["sha256"] = sha256(aside)
    write_text(path.with_suffix(".json"), json.dumps(record, indent=1))


def write_exr(path: Path, pixels: np.ndarray, names: list[str]) -> None:
    """Write pixels (H, W, C) float32.

    Raises:
        OSError: with the system's own reason, which OpenImageIO's message does not tell.
    """
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], len(names), oiio.FLOAT)
    spec.channelnames = tuple(names)
    spec.attribute("compression", "zip")
    spec.attribute("DateTime", "1970:01:01 00:00:00")  # the same picture gives the same bytes
    image = oiio.ImageOutput.create(str(path))
    if image.open(str(path), spec) and image.write_image(pixels) and image.close():
        return
    said = image.geterror() or "write failed"
    path.write_bytes(bytes(pixels.nbytes))  # the same room: fails as it did, for a reason
    raise OSError(errno.EIO, said)


def load_frame(path: Path) -> Frame:
    """Read a frame; a file without our JSON (an outside renderer's) has no ids and no times.

    Raises:
        InputError: the file is missing or cannot be decoded.
    """
    rgb = read_pixels(path, "frame")
    beside = path.with_suffix(".json")
    if not beside.is_file():
        return Frame(rgb)
    try:
        record = json.loads(beside.read_text())
        seconds = math.nan if record["seconds"] is None else float(record["seconds"])
        provenance = dict(record["provenance"])
        if record["sha256"] != sha256(path):
            return Frame(rgb)
        named = _channels(path) if record["has_ids"] or record["layers"] else {}
        ids = named["id"].astype(np.uint8) if record["has_ids"] else None
        layers = {
            name: np.stack([named[f"{name}.{c}"] for c in "RGB"], axis=2)
            for name in record["layers"]
        }
    except (OSError, ValueError, KeyError, TypeError):
        return Frame(rgb)
    return Frame(rgb, ids, seconds, provenance, layers)


def _channels(path: Path) -> dict[str, np.ndarray]:
    """Every channel of one of our own frames by name, (H, W) float32 each."""
    image = oiio.ImageBuf(str(path))
    pixels = image.get_pixels(oiio.FLOAT)
    return {name: pixels[..., i] for i, name in enumerate(image.spec().channelnames)}


def sha256(path: Path) -> str:
    """SHA-256 (hex) of a file as it is now; `scenes.schema.file_digest` remembers its answers."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def write_text(path: Path, text: str) -> None:
    """Write a text file (UTF-8) aside and rename it, so that a reader never sees half of it."""
    with written_aside(path) as aside:
        aside.write_text(text, encoding="utf-8")


@contextmanager
def written_aside(path: Path) -> Iterator[Path]:
    """A path to write, beside `path` and hidden; it becomes `path` if the block ends well.

    Two runs may share a folder, from two machines too: the name is drawn, not the process's.

    Raises:
        InputError: the folder cannot be written or the disk is full; nothing is left then.
    """
    aside = path.with_name(f".{secrets.token_hex(4)}-{path.name}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield aside
        os.replace(aside, path)
    except BaseException as error:
        with suppress(OSError):
            aside.unlink(missing_ok=True)
        if not isinstance(error, OSError):
            raise
        raise unwritable(path, "", error) from error


def unwritable(where: str | Path, field: str, error: OSError) -> InputError:
    """What to say where the system refuses a write."""
    full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
    remedy = "free some room, or choose another folder" if full else "choose another path"
    return InputError(where, field, f"cannot be written ({error.strerror or error})", remedy)
