"""Where and with what a run was made."""

import platform
from importlib import metadata
from typing import Any

from renderer.context import device

PACKAGES = ("mitsuba", "drjit", "moderngl", "numpy", "scipy")


def provenance(*packages: str) -> dict[str, Any]:
    """The machine, what draws on it, and versions: of what every run needs, and of `packages`."""
    return {
        "device": device().name,
        "opengl": device().version,
        "hardware_gpu": device().hardware,
        "machine": f"{platform.machine()}, {platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "versions": {p: metadata.version(p) for p in (*PACKAGES, *packages)},
    }
