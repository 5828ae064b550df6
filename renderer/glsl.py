"""GLSL sources with #include resolved and features as #defines."""

import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path

SHADERS = Path(__file__).parent / "shaders"
_INCLUDE = re.compile(r'^#include "([\w.]+)"[ \t]*$', re.MULTILINE)
SPAN = 1000  # more lines than any file has


def source(
    text: str,
    defines: frozenset[str] = frozenset(),
    parts: Mapping[str, str] | None = None,
    inline: bool = False,
) -> str:
    """One shader as the driver gets it, each file included once.

    Its #line directives say which file each line is of; see `place_of`.

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
        first = _files().index(name) * SPAN
        return f"#line {first + 1}\n{resolve(_read(name), first)}\n"

    def resolve(body: str, first: int) -> str:
        def included(match: re.Match) -> str:
            line = body.count("\n", 0, match.start()) + 1
            return (text := include(match[1])) and f"{text}#line {first + line + 1}"

        return _INCLUDE.sub(included, body)

    whole = text if inline else _read(text)
    first = 0 if inline else _files().index(text) * SPAN
    if not whole.startswith("#version"):
        whole, first = f"#version 330\n{whole}", first - 1
    version, body = resolve(whole, first).split("\n", 1)
    return "\n".join(
        [version, *(f"#define {d}" for d in sorted(defines)), f"#line {first + 2}", body]
    )


def place_of(line: int) -> str:
    """The file and line that a compiler's messages call so; "" for GLSL that stands in no file.

    Files are told apart by the thousands: of a #line directive's second number Mesa forgets most.
    """
    number, within = divmod(line, SPAN)
    return f"{SHADERS / _files()[number]}:{within}" if 0 < number < len(_files()) else ""


@cache
def _files() -> list[str]:
    """Every shader file, in the place of its thousand; the first is what stands in no file."""
    return ["", *sorted(path.name for path in SHADERS.iterdir())]


@cache
def _read(name: str) -> str:
    return (SHADERS / name).read_text(encoding="utf-8")
