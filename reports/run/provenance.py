"""Where and with what a run was made."""

import platform
from importlib import metadata
from typing import Any

PACKAGES = ("mitsuba", "drjit", "moderngl", "numpy", "scipy")


def provenance(*packages: str, drawn: bool = True) -> dict[str, Any]:
    """The machine, what draws on it, and versions: of what every run needs, and of `packages`.

    Args:
        drawn: by our own renderer, so that its device matters; else no OpenGL is asked for.
    """
    told = [p for p in (*PACKAGES, *packages) if _installed(p)]
    return (_device() if drawn else {}) | {
        "machine": f"{platform.machine()}, {platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "versions": {p: metadata.version(p) for p in told},
    }


def _device() -> dict[str, Any]:
    from renderer.context import device  # late: see reports.run.shots

    found = device()
    return {"device": found.name, "opengl": found.version, "hardware_gpu": found.hardware}


def _installed(package: str) -> bool:
    return any(metadata.distributions(name=package))
