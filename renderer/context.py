"""The OpenGL context: real GPU where there is one, Mesa's software rasteriser otherwise."""

from dataclasses import dataclass
from functools import cache

import moderngl

from scenes.errors import InputError

SOFTWARE = ("llvmpipe", "softpipe", "swrast", "software")
REMEDY = "install EGL and Mesa: apt-get install libegl1 libgl1 libgl1-mesa-dri"


@dataclass(frozen=True)
class Device:
    """What draws: its name, its OpenGL version (such as 450), and whether it is a real GPU."""

    name: str
    version: int
    hardware: bool


@cache
def context() -> moderngl.Context:
    """The one headless context of this process (EGL), made on first use.

    Raises:
        InputError: no EGL device offers OpenGL 3.3.
    """
    software = None
    for index in range(8):
        try:
            candidate = moderngl.create_context(
                standalone=True,
                backend="egl",
                device_index=index,
                require=330,
                libgl="libGL.so.1",
                libegl="libEGL.so.1",
            )
        except Exception as error:  # glcontext raises bare Exception for every failure
            if index == 0 and "not found" in str(error).lower():
                raise InputError("OpenGL", "EGL", str(error), REMEDY) from error
            break
        if not _is_software(candidate):
            if software:
                software.release()
            return _used(candidate)
        if software:
            candidate.release()
        software = software or candidate
    if software is None:
        raise InputError("OpenGL", "EGL", "no device offers OpenGL 3.3 without a display", REMEDY)
    return _used(software)


def _used(chosen: moderngl.Context) -> moderngl.Context:
    """Make a context current; what Python drops is freed on the GPU too."""
    chosen.__enter__()
    chosen.gc_mode = "auto"
    return chosen


def device() -> Device:
    """The device behind `context()`."""
    gl = context()
    return Device(str(gl.info["GL_RENDERER"]), gl.version_code, not _is_software(gl))


def _is_software(gl: moderngl.Context) -> bool:
    return any(word in str(gl.info["GL_RENDERER"]).lower() for word in SOFTWARE)
