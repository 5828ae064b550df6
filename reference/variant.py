"""Mitsuba, set up once: which variant, and for `llvm_ad_rgb` which LLVM library.

Dr.Jit loads the first LLVM it finds, and an LLVM that is too old aborts the process inside code
generation (LLVM 15 and 16: `Cannot select: fminimum`), which Python cannot catch. So a library
is tried in a process of its own before this process commits to it.
"""

import ctypes
import glob
import hashlib
import os
import re
import shutil
import subprocess
import sys
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

from scenes.errors import InputError
from scenes.frame import write_text

OLDEST_LLVM = 19
VARIABLE = "DRJIT_LIBLLVM_PATH"
NVIDIA = ("libcuda.so.1", "libnvoptix.so.1")  # the driver's libraries that Dr.Jit loads
REMEDY = f"apt-get install libllvm{OLDEST_LLVM}, or point {VARIABLE} at such a library"
# The smallest kernel that has `fminimum`, which LLVM 15 and 16 cannot compile.
PROBE = (
    "import drjit as dr; from drjit.llvm import Float;"
    "print(dr.sum(dr.minimum(dr.arange(Float, 64), 1))[0])"
)


@cache
def mitsuba() -> ModuleType:
    """The `mitsuba` module with its variant set: `cuda_ad_rgb` with an NVIDIA GPU, else LLVM.

    Raises:
        InputError: there is neither a GPU that can trace rays nor a usable LLVM library.
    """
    variant = "cuda_ad_rgb" if gpu() else "llvm_ad_rgb"
    if variant == "llvm_ad_rgb":
        os.environ[VARIABLE] = str(find_llvm())
    import mitsuba as mi

    mi.set_variant(variant)
    return mi


def find_llvm() -> Path:
    """The newest LLVM library that compiles a kernel; one named by DRJIT_LIBLLVM_PATH goes first.

    Raises:
        InputError: none works, or the one that the environment variable names does not.
    """
    if named := os.environ.get(VARIABLE):
        if works(Path(named)):  # a bare name is left to the system's loader
            return Path(named)
        raise InputError("LLVM", VARIABLE, f"{named} is missing or unusable", REMEDY)
    found = candidates()
    for library in found:
        if works(library):
            return library
    tried = ", ".join(map(str, found)) or "none found"
    problem = f"no usable library of version {OLDEST_LLVM} or later ({tried})"
    raise InputError("LLVM", "", problem, REMEDY)


def candidates() -> list[Path]:
    """LLVM libraries of a version that may work, the newest first, each file once."""
    names = glob.glob("/usr/lib/*/libLLVM*.so*") + glob.glob("/usr/lib/llvm-*/lib/libLLVM*.so*")
    # Debian keeps ldconfig in /sbin, which is not on every user's PATH.
    if ldconfig := shutil.which("ldconfig", path=f"{os.environ.get('PATH', '')}:/sbin:/usr/sbin"):
        listing = subprocess.run([ldconfig, "-p"], capture_output=True, text=True).stdout
        names += re.findall(r"=> (\S*/libLLVM\S*)", listing)
    files = {Path(name).resolve() for name in names if Path(name).is_file()}
    return sorted((f for f in files if _major(f) >= OLDEST_LLVM), key=_major, reverse=True)


def _major(library: Path) -> int:
    """The major version in a file name such as libLLVM.so.19.1 or libLLVM-15.so.1; 0 if none."""
    match = re.match(r"libLLVM(?:-(\d+)|\.so\.(\d+))", library.name)
    return int(match[1] or match[2]) if match else 0


def works(library: Path) -> bool:
    """Whether Dr.Jit can compile with this library; asked once, remembered on disk."""
    changed = library.stat().st_mtime_ns if library.is_file() else 0
    question = f"{library} {changed} {version('drjit')}"
    note = _cache_folder() / f"llvm-{hashlib.sha256(question.encode()).hexdigest()[:16]}.txt"
    if note.is_file():
        return note.read_text().endswith("works\n")
    command = [sys.executable, "-c", PROBE]
    environment = os.environ | {VARIABLE: str(library)}
    answer = subprocess.run(command, env=environment, capture_output=True, text=True)
    good = answer.returncode == 0 and answer.stdout.strip() == "63.0"
    with suppress(InputError):  # a cache that cannot be written costs the next run a second
        write_text(note, f"{question}\n{'works' if good else 'fails'}\n")
    return good


def _cache_folder() -> Path:
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(home) / "shadeproof"


@cache
def gpu() -> str:
    """The name of the NVIDIA GPU that Mitsuba can trace rays on; empty where there is none.

    Rays take the driver's OptiX library beside CUDA. A container that was given the GPU for
    computing alone lacks it.
    """
    try:
        driver, _ = (ctypes.CDLL(library) for library in NVIDIA)
    except OSError:
        return ""
    count, device, name = ctypes.c_int(), ctypes.c_int(), ctypes.create_string_buffer(256)
    if driver.cuInit(0) or driver.cuDeviceGetCount(ctypes.byref(count)) or not count.value:
        return ""
    driver.cuDeviceGet(ctypes.byref(device), 0)
    driver.cuDeviceGetName(name, len(name), device)
    return name.value.decode()
