"""GLSL sources with #include resolved and features as #defines."""

import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path

SHADERS = Path(__file__).parent / "shaders"
_INCLUDE = re.compile(r'^#include "([\w.]+)"[ \t]*$', re.MULTILINE)


def source(
    text: str,
    defines: frozenset[str] = frozenset(),
    parts: Mapping[str, str] | None = None,
    inline: bool = False,
) -> str:
    """One shader as the driver gets it, each file included once.

    Args:
        text: a file in renderer/shaders or, if `inline`, GLSL itself. Without a #version line,
            330 is put on top.
        defines: names of features to #define after the #version line.
        parts: stand-ins for included names, such as {"shade.glsl": "shade_paper.glsl"}.
    """
    seen: set[str] = set()

    def include(name: str) -> str:
        name = (parts or {}).get(name, name)
        if name in seen:
            return ""
        seen.add(name)
        return resolve(_read(name))

    def resolve(body: str) -> str:
        return _INCLUDE.sub(lambda match: include(match[1]), body)

    whole = resolve(text) if inline else include(text)
    if not whole.startswith("#version"):
        whole = "#version 330\n" + whole
    version, body = whole.split("\n", 1)
    return "\n".join([version, *(f"#define {d}" for d in sorted(defines)), body])


@cache
def _read(name: str) -> str:
    return (SHADERS / name).read_text(encoding="utf-8")
