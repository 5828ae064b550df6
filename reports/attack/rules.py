"""Mutants by rule: every small slip that a hand could make in a line of GLSL, one at a time."""

import random
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

SOURCES = (".glsl", ".frag", ".vert")
NAME = r"[A-Za-z_]\w*"
NUMBER = r"(?<![\w.])\d+\.\d*(?:e[+-]?\d+)?|(?<![\w.])\d+(?:e[+-]?\d+)?(?![\w.])"
FLIPPED = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}
SWAPPED = {" + ": " - ", " - ": " + ", " * ": " / ", " / ": " * ", "+=": "-=", "*=": "/="}
SWAPPED |= {"-=": "+=", "/=": "*=", "&&": "||", "||": "&&"}
SWIZZLED = {"x": "y", "y": "x", "z": "x", "w": "z", "xy": "yx", "zw": "xy", "xyz": "xzy"}
# Calls whose first argument is what they would leave without them.
GUARDS = ("normalize", "clamp", "abs", "max", "min", "sqrt", "fract", "length")
# Whose arguments may trade places without meaning much.
LIKE = ("min", "max", "dot", "vec2", "vec3", "vec4", "mat3", "ivec2", "ivec3", "main", "if", "for")
LIKE += ("textureLod", "texelFetch", "textureSize")
PLAIN = re.compile(r"^\s*(//|#|uniform\b|in\b|out\b|layout\b|centroid\b|struct\b|\}|$)")


@dataclass(frozen=True)
class Patch:
    """A change of one line of a file in the renderer; `line` counts from 1."""

    rule: str
    file: str
    line: int
    before: str
    after: str


def patches(room: Path) -> list[Patch]:
    """Every mutant of every shader under a copy of the folder renderer/, in a fixed order."""
    return [
        Patch(rule, path.relative_to(room).as_posix(), number, line, after)
        for path in sorted(room.rglob("*"))
        if path.suffix in SOURCES
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        for rule, after in changes(line)
    ]


def changes(line: str) -> Iterator[tuple[str, str]]:
    """Rule and changed line, for every change of one line; comments and declarations have none."""
    if PLAIN.match(line):
        return
    code, mark, comment = line.partition("//")
    # A function's own head names no values.
    if re.match(rf"\s*{NAME} {NAME}\(.*\) \{{\s*$", code):
        return
    seen = {code}
    for rule, changed in _changes(code):
        if changed not in seen:
            seen.add(changed)
            yield rule, changed + mark + comment


def _changes(code: str) -> Iterator[tuple[str, str]]:
    def put(match: re.Match, text: str) -> str:
        return code[: match.start()] + text + code[match.end() :]

    for match in re.finditer(r" [-+*/] |[-+*/]=|&&|\|\|", code):
        yield "operator", put(match, SWAPPED[match[0]])
    for match in re.finditer(NUMBER, code):
        yield "constant", put(match, _other(match[0]))
    for match in re.finditer(r"(?<=[\w)\]]\.)([xyzw]{1,3})\b", code):
        if match[0] in SWIZZLED:
            yield "swizzle", put(match, SWIZZLED[match[0]])
    for match in re.finditer(r" (<=|>=|==|!=|<|>) ", code):
        yield "comparison", put(match, f" {FLIPPED[match[1]]} ")
    for match in re.finditer(r"\b(min|max)\(", code):
        yield "extremum", put(match, "max(" if match[1] == "min" else "min(")
    for match in re.finditer(r" [*/] ", code):
        end = _operand(code, match.end())
        yield "dropped factor", code[: match.start()] + code[end:]
    for match in re.finditer(r" [-+] ", code):
        end = match.end()
        while (end := _operand(code, end)) < len(code) and re.match(r" [*/] ", code[end:]):
            end += 3
        yield "dropped term", code[: match.start()] + code[end:]
    for match in re.finditer(rf"\b({NAME})\(", code):
        parts, end = _arguments(code, match.end())
        if match[1] in GUARDS:
            yield "dropped call", code[: match.start()] + f"({parts[0]})" + code[end:]
        if len(parts) > 1 and match[1] not in LIKE:
            for k in range(len(parts) - 1):
                other = [*parts[:k], parts[k + 1], parts[k], *parts[k + 2 :]]
                yield "swapped arguments", code[: match.end()] + ", ".join(other) + code[end - 1 :]


def _other(number: str) -> str:
    """A tenth more of a real number, one more of a whole one."""
    if number.isdigit():
        return str(int(number) + 1)
    value = float(number) * 1.1 or 0.1
    return f"{value:.9g}" if re.search(r"[.e]", f"{value:.9g}") else f"{value:.1f}"


def _operand(code: str, start: int) -> int:
    """Where the operand ends that begins at `start`: a name, number, call or bracket, swizzled."""
    end = start
    while end < len(code):
        if code[end] in "([":
            end = _arguments(code, end + 1)[1]
        elif re.match(r"[\w.]", code[end]) or (code[end] == "-" and end == start):
            end += 1
        else:
            break
    return end


def _arguments(code: str, start: int) -> tuple[list[str], int]:
    """The arguments of the bracket that opens before `start`, and where it has closed."""
    parts, depth, begun = [], 0, start
    for place in range(start, len(code)):
        if code[place] in ")]" and depth == 0:
            return [*parts, code[begun:place].strip()], place + 1
        if code[place] == "," and depth == 0:
            parts.append(code[begun:place].strip())
            begun = place + 1
        depth += (code[place] in "([") - (code[place] in ")]")
    return [*parts, code[begun:].strip()], len(code)  # it closes on another line


def chosen(every: Sequence[Patch], count: int, seed: int) -> list[Patch]:
    """At most `count` of them, in file order: from every file, and of every rule, in turn."""
    drawn = random.Random(seed).sample(every, len(every))
    groups = [
        [
            [p for p in drawn if getattr(p, of) == value]
            for value in sorted({getattr(p, of) for p in drawn})
        ]
        for of in ("file", "rule")
    ]
    # By turns the next of a file and the next of a rule.
    turns = [[p for layer in zip_longest(*group) for p in layer if p] for group in groups]
    order = dict.fromkeys(p for pair in zip(*turns, strict=True) for p in pair)
    taken = set(list(order)[:count])
    return [p for p in every if p in taken]
