"""Mutations of what TOML and JSON hold: values, keys and nesting that no one meant."""

import json
import random
import re
from typing import Any

import tomlkit

# Written as they stand, where no value of Python would give them.
RAW = {
    "toml": (
        "nan", "-inf", "-0.0", "1e400", "1e-400", "1_000", "+1", "", "9" * 40, "9" * 5000,
        "0x" + "f" * 5000, "1979-05-27", "07:32:00", "[" * 1000 + "]" * 1000,
        "{a=" * 1000 + "1" + "}" * 1000, '"\\ud800"', '"\\U00110000"', "'''\n\n'''",
    ),
    "json": (
        "NaN", "-Infinity", "-0.0", "1e400", "1e-400", "01", "", "9" * 40, "9" * 5000, '"\\ud800"',
        "[" * 1000 + "]" * 1000, '{"a":' * 1000 + "1" + "}" * 1000,
    ),
}  # fmt: skip
VALUES = (
    None, True, False, 0, 1, -1, 2, 3.5, 1e308, -1e308, 5e-324, 1e39, 1e-39, 2**31, 2**63 - 1,
    -(2**63), 16384, 16385, 99999, [], {}, [[]], [{}], [0, 0], [1.0, 2.0], [1.0] * 3, [1.0] * 4,
    [0] * 3000, "", " ", ".", "..", "/", "~", "/dev/zero", "/dev/full", "here", "here.toml",
    "loop.toml", "fifo.ply", "folder.exr", "zero.ply", "zero.exr", "zero.toml", "full.toml",
    "scene.toml", "sky.exr", "brass.toml", "../" * 400, "a" * 100_000, "x" * 300 + ".toml",
    "é" * 180, "😀" * 60, "\u202egpj.exr", "a\nb", "a\r\nb: c; d", "nul\0", "\x1b[31mred",
    "\u2028", "\ufeff", "{case}", "%s%n", "$(id)", "<b>", "[red]rich[/]", "paper", "sampled@0",
    "sampled@999999", "sampled@1e3", "global", "physical", "exact", "interface", "Cu", "water",
    "sphere", "plane", "bunny", "copper", "studio",
)  # fmt: skip


def mutated(text: str, form: str, rng: random.Random) -> tuple[bytes, str]:
    """A TOML or JSON text with one to three changes of its tree, and what was done."""
    import tomllib

    tree = tomllib.loads(text) if form == "toml" else json.loads(text)
    raws: list[str] = []
    done = [_change(tree, form, rng, raws) for _ in range(rng.choice((1, 1, 1, 2, 3)))]
    written = _written(tree, form)
    written = re.sub(r'"@raw(\d+)@"', lambda found: raws[int(found[1])], written)
    if rng.random() < 0.04:
        lines = written.splitlines()
        lines.insert(rng.randrange(len(lines)), rng.choice(lines))  # a key twice
        written, done = "\n".join(lines), [*done, "line twice"]
    return written.encode("utf-8", "surrogatepass"), "+".join(done)


def _written(tree: Any, form: str) -> str:
    return tomlkit.dumps(_without_null(tree)) if form == "toml" else json.dumps(tree, indent=1)


def _without_null(tree: Any) -> Any:
    """TOML has no null."""
    if isinstance(tree, dict):
        return {k: _without_null(v) for k, v in tree.items() if v is not None}
    if isinstance(tree, list):
        return [_without_null(v) for v in tree if v is not None]
    return tree


def places(tree: Any) -> list[tuple[Any, Any]]:
    """Every (container, key) in a tree."""
    keys = tree.keys() if isinstance(tree, dict) else range(len(tree))
    found = [(tree, key) for key in keys]
    for key in keys:
        if isinstance(tree[key], dict | list):
            found += places(tree[key])
    return found


def _change(tree: Any, form: str, rng: random.Random, raws: list[str]) -> str:
    if not (found := places(tree)):
        return "nothing left"
    holder, key = rng.choice(found)
    what = rng.choices(("value", "drop", "rename", "add", "wrap", "swap"), (8, 2, 2, 2, 1, 1))[0]
    if what == "value":
        if rng.random() < 0.3:
            raws.append(rng.choice(RAW[form]))
            holder[key] = f"@raw{len(raws) - 1}@"
        else:
            holder[key] = _copy(rng.choice(VALUES))
        return f"value of {str(key)[:40]}"
    if what == "drop":
        del holder[key]
    elif what == "rename" and isinstance(holder, dict):
        holder[_name(rng)] = holder.pop(key)
    elif what == "add":
        value = _copy(rng.choice(VALUES))
        if isinstance(holder, dict):
            holder[_name(rng)] = value
        else:
            holder.insert(0, value)
    elif what == "wrap":
        holder[key] = rng.choice(([holder[key]], {str(key): holder[key]}))
    else:
        other, where = rng.choice(found)
        if isinstance(holder, dict) or key < len(holder):
            try:
                holder[key] = _copy(other[where])
            except (KeyError, IndexError):
                return "swap with nothing"
    return f"{what} {str(key)[:40]}"


def _name(rng: random.Random) -> str:
    """A key, such as another place's or one that nobody would write."""
    words = ("weight", "metal", "truths", "albedo", "use", "schema", "name", "path", "object")
    return rng.choice((*words, *(v for v in VALUES if isinstance(v, str))))


def _copy(value: Any) -> Any:
    return json.loads(json.dumps(value)) if isinstance(value, dict | list) else value
