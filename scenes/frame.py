"""Frame: one answer to a case, in memory and on disk as EXR plus JSON."""

import json
import os
from contextlib import suppress
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

    The JSON is written last: a frame without it is unfinished.

    Raises:
        InputError: the folder cannot be written or the disk is full.
    """
    record = {"seconds": frame.seconds, "provenance": frame.provenance}
    record |= {"has_ids": frame.ids is not None, "layers": list(frame.layers)}
    channels, names = [frame.rgb.astype(np.float32)], ["R", "G", "B"]
    if frame.ids is not None:
        channels.append(frame.ids[..., None].astype(np.float32))
        names.append("id")
    for name, layer in frame.layers.items():
        channels.append(layer.astype(np.float32))
        names += [f"{name}.{c}" for c in "RGB"]
    pixels = np.ascontiguousarray(np.concatenate(channels, axis=2))
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], len(names), oiio.FLOAT)
    spec.channelnames = tuple(names)
    spec.attribute("compression", "zip")
    aside = path.with_name(f".{os.getpid()}-{path.name}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        image = oiio.ImageOutput.create(str(aside))
        if not (image.open(str(aside), spec) and image.write_image(pixels) and image.close()):
            raise OSError(image.geterror() or "write failed")
        path.with_suffix(".json").unlink(missing_ok=True)
        os.replace(aside, path)
        write_text(path.with_suffix(".json"), json.dumps(record, indent=1))
    except OSError as error:
        with suppress(OSError):
            aside.unlink(missing_ok=True)
        raise InputError(
            path, "", f"cannot be written ({error})", "free or choose a folder"
        ) from error


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
        seconds, provenance = float(record["seconds"]), dict(record["provenance"])
        named = _channels(path) if record["has_ids"] or record["layers"] else {}
        ids = named["id"].astype(np.uint8) if record["has_ids"] else None
        layers = {
            name: np.stack([named[f"{name}.{c}"] for c in "RGB"], axis=2)
            for name in record["layers"]
        }
    except (ValueError, KeyError, TypeError):
        return Frame(rgb)
    return Frame(rgb, ids, seconds, provenance, layers)


def _channels(path: Path) -> dict[str, np.ndarray]:
    """Every channel of one of our own frames by name, (H, W) float32 each."""
    image = oiio.ImageBuf(str(path))
    pixels = image.get_pixels(oiio.FLOAT)
    return {name: pixels[..., i] for i, name in enumerate(image.spec().channelnames)}


def write_text(path: Path, text: str) -> None:
    """Write a text file aside and rename it, so that a reader never sees half of it."""
    aside = path.with_name(f".{os.getpid()}-{path.name}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        aside.write_text(text)
        os.replace(aside, path)
    except OSError as error:
        with suppress(OSError):
            aside.unlink(missing_ok=True)
        raise InputError(
            path, "", f"cannot be written ({error})", "free or choose a folder"
        ) from error
