"""Memory: how far this process grows, and what OpenGL objects hold."""

import ctypes
import gc
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from math import nan
from pathlib import Path

import moderngl

STATUS, REFERENCES = Path("/proc/self/status"), Path("/proc/self/clear_refs")
FORGET_PEAK = "5"  # proc(5): sets VmHWM back to VmRSS
TEXEL = {"f1": 1, "u1": 1, "i1": 1, "f2": 2, "u2": 2, "i2": 2, "f4": 4, "u4": 4, "i4": 4}
MIPMAPS = 4 / 3  # of the finest level; 1 + 1/4 + 1/16 ...
DEPTH = 4  # bytes of a depth value, with its padding
MIPMAPPED = (
    moderngl.NEAREST_MIPMAP_NEAREST,
    moderngl.LINEAR_MIPMAP_NEAREST,
    moderngl.NEAREST_MIPMAP_LINEAR,
    moderngl.LINEAR_MIPMAP_LINEAR,
)


@dataclass
class Growth:
    """Resident bytes beyond those before: at the peak, and at the end. NaN where none tells."""

    peak: float = nan
    left: float = nan


@contextmanager
def growing() -> Iterator[Growth]:
    """Measure by how much the block makes this process grow.

    Memory that was freed and kept by the allocator is given back first, or the block would grow
    into it unseen. What Dr.Jit keeps is for the caller to flush.
    """
    growth = Growth()
    gc.collect()
    with suppress(OSError, AttributeError):  # not glibc
        ctypes.CDLL(None).malloc_trim(0)
    before, peak_known = _told("VmRSS"), _forget_peak()
    yield growth
    growth.left = _told("VmRSS") - before
    if peak_known:
        growth.peak = max(_told("VmHWM") - before, 0.0)


def _told(field: str) -> float:
    """A field of /proc/self/status in bytes; NaN where there is none."""
    try:
        found = re.search(rf"^{field}:\s+(\d+) kB$", STATUS.read_text(), re.MULTILINE)
    except OSError:
        return nan
    return 1024.0 * int(found[1]) if found else nan


def _forget_peak() -> bool:
    try:
        REFERENCES.write_text(FORGET_PEAK)
    except OSError:
        return False
    return True


def held_bytes() -> float:
    """Bytes of all buffers, textures and renderbuffers that this process holds."""
    return float(sum(_bytes(found) for found in gc.get_objects()))


def _bytes(found: object) -> float:
    if isinstance(found, moderngl.Buffer):
        return found.size if _alive(found) else 0
    if not isinstance(found, moderngl.Texture | moderngl.Renderbuffer) or not _alive(found):
        return 0
    texel = DEPTH if found.depth else found.components * TEXEL[found.dtype]
    size = found.width * found.height * texel * max(found.samples, 1)
    mipmapped = isinstance(found, moderngl.Texture) and found.filter[0] in MIPMAPPED
    return size * (MIPMAPS if mipmapped else 1)


def _alive(found: object) -> bool:
    """Whether it has not been released."""
    return not isinstance(found.mglo, moderngl.mgl.InvalidObject)
