"""One input by its seed and number: which file, how it is spoilt, and the command that reads it."""

import os
import random
import shutil
import zlib
from dataclasses import dataclass
from pathlib import Path

from tests.fuzz import raw, trees
from tests.fuzz.corpus import HERE, lay
from tests.fuzz.formats import KNOWING

MESHES = ("ply", "obj", "stl", "glb")
# How often each kind comes; a candidate takes a whole comparison.
SHARES = {
    "suite": 16, "scene": 14, "material": 8, "case": 4, "ply": 8, "obj": 8, "stl": 4, "glb": 10,
    "exr": 14, "hdr": 6, "candidate": 3, "frame": 2, "half": 2, "results": 5, "bench": 5, "refs": 6,
}  # fmt: skip
TREES = {"suite": "toml", "scene": "toml", "material": "toml"}
TREES |= {"case": "json", "results": "json", "bench": "json", "half": "json"}
DRAWN = 0.35  # share of what loads that is drawn too: it takes longest
OTHER_THINGS = 0.015  # share of inputs that are no file at all
EARLIER = ("report.html", "junit.xml", "summary.md")


@dataclass(frozen=True)
class Input:
    """A spoilt file in a folder, and what to run.

    Attributes:
        how: what was done to which variant of the kind.
        words: the arguments of the command.
        watched: folders in which a refusal leaves nothing.
        drawn: the suite to draw if the command takes it; none if empty.
    """

    number: int
    kind: str
    how: str
    words: list[str]
    watched: tuple[Path, ...]
    drawn: str = ""


def lay_input(
    seed: int, number: int, files: dict[str, dict[str, bytes]], store: Path, folder: Path
) -> Input:
    """Write an input into an empty folder.

    Args:
        files: as `corpus` makes them.
        store: the references of the valid suite.
    """
    rng = random.Random(zlib.crc32(f"{seed} {number}".encode()))
    kind = rng.choices(list(SHARES), list(SHARES.values()))[0]
    source = "exr" if kind in ("candidate", "frame") else kind
    variant, data = rng.choice(sorted(files[source].items()))
    source = source if variant != "exr" else "exr"  # a half is a picture and its JSON
    changed, how = _changed(source, data, rng.choice(list(files[source].values())), rng)
    target, words, watched, drawn = _use(kind, variant, folder, files, store)
    if source == "case":
        changed = changed.replace(HERE.encode(), str(folder.resolve()).encode())
    target.unlink(missing_ok=True)
    if rng.random() < OTHER_THINGS:
        how = _put_other_thing(target, rng)
    else:
        target.write_bytes(changed)
    drawn = drawn if rng.random() < DRAWN else ""
    return Input(number, kind, f"{variant}: {how}", words, watched, drawn)


def _changed(source: str, data: bytes, other: bytes, rng: random.Random) -> tuple[bytes, str]:
    if source in TREES and rng.random() < 0.75:
        return trees.mutated(data.decode(), TREES[source], rng)
    if source in KNOWING and rng.random() < 0.6:
        return KNOWING[source](data, rng)
    return raw.mutated(data, other, rng)


def _use(
    kind: str, variant: str, folder: Path, files: dict[str, dict[str, bytes]], store: Path
) -> tuple[Path, list[str], tuple[Path, ...], str]:
    """What reads a kind: the file's path, the command, the watched folders, the suite to draw."""
    lay(folder, files)
    _lay_traps(folder)
    (out := folder / "out").mkdir()
    for name in EARLIER:
        (out / name).write_text("of an earlier run")
    suite = folder / "suite.toml"
    if kind == "results":
        return out / "results.json", ["report", "--out", str(out)], (out,), ""
    if kind == "frame":
        _results(out, files)
        return out / "paper.exr", ["report", "--out", str(out)], (out,), ""
    if kind == "half":
        _results(out, files)
        return out / f"a.{variant}", ["report", "--out", str(out)], (out,), ""
    if kind == "bench":
        _results(out, files)
        if folder.name[-1] in "02468":
            return out / "bench.json", ["report", "--out", str(out)], (out,), ""
        words = ["plan", "--bench", str(folder / "bench.json"), "--max-error", "0.5"]
        return folder / "bench.json", [*words, "--to", str(out / "plan.toml")], (out,), ""
    if kind == "refs":
        into = folder / "store"
        return (
            folder / "a.refs",
            ["refs", "unpack", str(folder / "a.refs"), "--store", str(into)],
            (folder,),
            "",
        )
    if kind == "case":
        words = ["!crosscheck", "/bin/true", str(folder / "case.json"), str(out / "out.exr")]
        return folder / "case.json", words, (out,), ""
    if kind == "candidate":
        (frames := folder / "frames").mkdir()
        words = [
            "gate",
            "--frozen",
            "--suite",
            str(suite),
            "--store",
            str(store),
            "--out",
            str(out),
        ]
        (frames / "scene.sky.brass.weight=0.5.exr").write_bytes(b"")
        target = frames / "scene.sky.brass.weight=0.5.exr"
        return target, [*words, "--candidate", str(frames)], (), ""
    words = ["compare", "--dry-run", "--suite", str(suite), "--out", str(out)]
    words += ["--store", str(folder / "none")]
    names = {"suite": "suite.toml", "scene": "scene.toml", "material": "brass.toml"}
    target = folder / names.get(kind, f"sky.{kind}")
    if kind in MESHES:
        target = folder / f"thing.{kind}"
        scene = folder / "scene.toml"
        scene.write_text(scene.read_text().replace('mesh = "plane"', f'mesh = "{target.name}"', 1))
    elif kind == "hdr":
        suite.write_text(suite.read_text().replace("sky.exr", "sky.hdr"))
    return target, words, (folder,), str(suite)


def _results(out: Path, files: dict[str, dict[str, bytes]]) -> None:
    (out / "results.json").write_bytes(files["results"]["json"])
    (out / "paper.exr").write_bytes(files["exr"]["zip"])
    for name in ("a", "b"):
        for form, content in files["half"].items():
            (out / f"{name}.{form}").write_bytes(content)


def _lay_traps(folder: Path) -> None:
    """What a path in a file may lead to."""
    (folder / "folder.exr").mkdir()
    (folder / "loop.toml").symlink_to("loop.toml")
    for name in ("zero.ply", "zero.exr", "zero.toml", "zero.mtl"):
        (folder / name).symlink_to("/dev/zero")
    (folder / "full.toml").symlink_to("/dev/full")
    for name in ("fifo.ply", "fifo.mtl"):
        os.mkfifo(folder / name)


def _put_other_thing(target: Path, rng: random.Random) -> str:
    """In the file's place, what is no file, or holds nothing, or may not be read."""
    what = rng.choice(("folder", "fifo", "loop", "zero", "full", "empty", "gone", "locked", "lost"))
    if what == "folder":
        target.mkdir()
    elif what == "fifo":
        os.mkfifo(target)
    elif what == "empty":
        target.write_bytes(b"")
    elif what == "locked":
        target.write_bytes(b"x")
        target.chmod(0)
    elif what != "gone":
        aims = {"loop": target.name, "zero": "/dev/zero", "full": "/dev/full", "lost": "nowhere"}
        target.symlink_to(aims[what])
    return what


def clear(folder: Path) -> None:
    """Remove a folder of an input."""
    shutil.rmtree(folder, ignore_errors=True)
