"""What is injected: bugs and harmless rewrites written by hand, and mutants by rule."""

import tomllib
from dataclasses import dataclass
from pathlib import Path

from reports.attack.results import Kind
from reports.attack.rules import Patch, chosen, patches

HERE = Path(__file__).parent
RENDERER = HERE.parents[1] / "renderer"


@dataclass(frozen=True)
class Change:
    """A text of one file of the renderer, and what stands there instead.

    Attributes:
        file: relative to the folder renderer/.
        line: where `before` begins, from 1.
        equivalent: why nobody could see the change; "" unless it was argued.
    """

    id: str
    kind: Kind
    rule: str
    file: str
    line: int
    before: str
    after: str
    words: str = ""
    equivalent: str = ""

    def apply(self, room: Path) -> None:
        """Make the change in a copy of the renderer."""
        path = room / self.file
        text = path.read_text(encoding="utf-8")
        lines = text.splitlines(keepends=True)
        place = sum(map(len, lines[: self.line - 1]))
        place = text.index(self.before, place)
        path.write_text(
            text[:place] + self.after + text[place + len(self.before) :], encoding="utf-8"
        )


def written(kind: Kind, room: Path = RENDERER) -> list[Change]:
    """The bugs (`realistic`) or the harmless rewrites (`control`) of this folder's TOML files.

    Raises:
        ValueError: a text does not stand exactly once in its file.
    """
    name = {"realistic": "bugs.toml", "control": "controls.toml"}[kind]
    found = []
    for entry in _read(name)["change"]:
        text = (room / entry["file"]).read_text(encoding="utf-8")
        if (times := text.count(entry["before"])) != 1:
            raise ValueError(
                f"{name}: '{entry['name']}': its text stands {times} times in {entry['file']}"
            )
        line = text[: text.index(entry["before"])].count("\n") + 1
        found.append(
            Change(
                id=entry["name"],
                kind=kind,
                rule="",
                file=entry["file"],
                line=line,
                before=entry["before"],
                after=entry["after"],
                words=entry.get("words", ""),
                equivalent=argument(entry["file"], entry["before"], entry["after"]),
            )
        )
    return found


def by_rule(every: list[Patch]) -> list[Change]:
    """Mutants by rule, named by file, line, rule and number."""
    made, numbers = [], {}
    for p in every:
        stem = f"{Path(p.file).name}:{p.line}:{p.rule.replace(' ', '-')}"
        numbers[stem] = numbers.get(stem, 0) + 1
        made.append(
            Change(
                id=f"{stem}:{numbers[stem]}",
                kind="rule",
                rule=p.rule,
                file=p.file,
                line=p.line,
                before=p.before,
                after=p.after,
                equivalent=argument(p.file, p.before, p.after),
            )
        )
    return made


def select(count: int, seed: int) -> tuple[list[Change], int]:
    """All bugs and controls, `count` of the mutants by rule, and how many of those there are."""
    every = patches(RENDERER)
    # Named before the choice, so that a name stays whatever is chosen.
    named = dict(zip(every, by_rule(every), strict=True))
    drawn = [named[p] for p in chosen(every, count, seed)]
    return [*written("control"), *written("realistic"), *drawn], len(every)


def arguments() -> list[dict[str, str]]:
    """Changes that nobody could see: file, before, after (each a line's text) and why."""
    return _read("equivalent.toml").get("change", [])


def argument(file: str, before: str, after: str) -> str:
    """Why a change is equivalent; "" where nobody argued so."""
    for entry in arguments():
        told = entry["file"], entry["before"].strip(), entry["after"].strip()
        if told == (file, before.strip(), after.strip()):
            return entry["why"]
    return ""


def _read(name: str) -> dict:
    return tomllib.loads((HERE / name).read_text(encoding="utf-8"))
