"""GLSL sources with #include resolved and features as #defines."""

import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path

SHADERS = Path(__file__).parent / "shaders"
_INCLUDE = re.compile(r'^#include "([\w.]+)"\s*$', re.MULTILINE)


def source(name: str, defines: frozenset[str] = frozenset(), parts: Mapping[str, str] | None = None) -> str:
    """One shader as the driver gets it, each file included once.

    Args:
        name: a file in renderer/shaders; without a #version line, 330 is put on top.
        defines: names of features to #define after the #version line.
        parts: stands-in for included names, such as {"shade.glsl": "shade_paper.glsl"}.
    """
    seen: set[str] = set()

    def expand(file: str) -> str:
        file = (parts or {}).get(file, file)
        if file in seen:
            return ""
        seen.add(file)
        return _INCLUDE.sub(lambda m: expand(m[1]), _read(file))

    text = expand(name)
    if not text.startswith("#version"):
        text = "#version 330\n" + text
    version, body = text.split("\n", 1)
    return "\n".join([version, *(f"#define {d}" for d in sorted(defines)), body])


@cache
def _read(name: str) -> str:
    return (SHADERS / name).read_text(encoding="utf-8")
