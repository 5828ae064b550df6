"""An attack to what the template shows: what the gate let through first."""

import json
import re
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from textwrap import dedent

from reports.attack.results import Attack, Mutant
from reports.html.attack.matrix import BugMatrix, bug_matrix
from reports.html.attack.words import plainly
from reports.html.figures import count, seconds, slug
from reports.html.trust import Fact, versions_of

ORDER = ("alarm", "survived", "timeout", "stillborn", "caught", "passed")
BADGES = {"caught": "pass", "passed": "pass", "survived": "fail", "alarm": "fail"}
OUTCOMES = {"alarm": "false alarm"}


@dataclass(frozen=True)
class Change:
    """A text before and after, each in pieces, and of each piece whether it differs."""

    before: list[tuple[str, bool]]
    after: list[tuple[str, bool]]


@dataclass(frozen=True)
class MutantView:
    """One change of the renderer and what became of it; `told` is why."""

    mutant: Mutant
    place: str
    change: Change
    outcome: str
    badge: str
    told: str

    @property
    def title(self) -> str:
        """What it is: the name that people gave it, or the rule that made it."""
        return self.mutant.rule or self.mutant.id

    @property
    def command(self) -> str:
        """What tries it again."""
        return shlex.join(["shadeproof", "attack", "--only", self.mutant.id])


@dataclass(frozen=True)
class Part:
    """A share of the bugs: how many, what became of them, and a class for the colour."""

    count: int
    words: str
    kind: str


@dataclass(frozen=True)
class FileView:
    """The bugs of one file that rules made."""

    name: str
    id: str
    told: str
    mutants: list[MutantView]


@dataclass(frozen=True)
class AttackView:
    """The whole section."""

    headline: str
    state: str
    parts: list[Part]
    missed: list[MutantView]
    alarms: list[MutantView]
    controls_told: str
    matrix: BugMatrix
    realistic: list[MutantView]
    equivalent: list[MutantView]
    stillborn: list[MutantView]
    controls: list[MutantView]
    files: list[FileView]
    facts: list[Fact]
    command: str
    provenance: str


def attack_view(attack: Attack) -> AttackView:
    """Everything that the section shows."""
    shown = [_mutant(m) for m in sorted(attack.mutants, key=lambda m: ORDER.index(m.outcome))]
    bugs = [v for v in shown if v.mutant.kind != "control"]
    controls = [v for v in shown if v.mutant.kind == "control"]
    files = _files(bugs)
    return AttackView(
        headline=headline(attack),
        state="pass" if attack.passed else "fail",
        parts=_parts(bugs),
        missed=[v for v in bugs if v.outcome == "survived"],
        alarms=[v for v in controls if v.mutant.outcome != "passed"],
        controls_told=_controls(controls),
        matrix=bug_matrix(attack.mutants, {f.name: f.id for f in files}),
        realistic=[v for v in bugs if v.mutant.kind == "realistic"],
        equivalent=[v for v in bugs if v.outcome == "equivalent"],
        stillborn=[v for v in bugs if v.mutant.outcome == "stillborn"],
        controls=controls,
        files=files,
        facts=[
            Fact("Judged by", f"the gate, on the suite {attack.suite}"),
            Fact("Bugs by rule", _chosen(attack)),
            Fact("Measured", f"{attack.created}, in {seconds(attack.seconds)}"),
            Fact("Device", str(attack.provenance.get("device", "not named"))),
            Fact("Versions", versions_of(attack.provenance)),
        ],
        command=attack.command,
        provenance=json.dumps(attack.provenance, indent=2, ensure_ascii=False, default=str),
    )


def headline(attack: Attack) -> str:
    """The score in one sentence; bugs that no user could see and stillborn ones are left out."""
    bugs = [m for m in attack.mutants if m.kind != "control"]
    controls = [m for m in attack.mutants if m.kind == "control"]
    caught, missed = (sum(m.outcome == "caught" for m in bugs), len(attack.unexplained))
    if not caught + missed:
        return "No bug was tried on the gate"
    score = f"the gate catches {count(caught)} of {count(caught + missed)} injected bugs"
    if not controls:
        return score[0].upper() + score[1:]
    passed = sum(m.outcome == "passed" for m in controls)
    return f"{score[0].upper()}{score[1:]} and passes {passed} of {len(controls)} harmless rewrites"


def change_of(before: str, after: str) -> Change:
    """What differs between two texts, word by word, without the indentation that they share."""
    lines = dedent("\n".join([before, after])).split("\n")
    count = before.count("\n") + 1
    texts = "\n".join(lines[:count]), "\n".join(lines[count:])
    a, b = (re.findall(r"\w+|.", text, re.DOTALL) for text in texts)
    steps = SequenceMatcher(None, a, b, autojunk=False).get_opcodes()
    return Change(
        [("".join(a[i:j]), kind != "equal") for kind, i, j, _, _ in steps if i < j],
        [("".join(b[i:j]), kind != "equal") for kind, _, _, i, j in steps if i < j],
    )


def _mutant(mutant: Mutant) -> MutantView:
    outcome, badge = (
        OUTCOMES.get(mutant.outcome, mutant.outcome),
        BADGES.get(mutant.outcome, "reported"),
    )
    if mutant.outcome == "survived" and mutant.equivalent:
        outcome, badge = "equivalent", "reported"
    place = f"{mutant.file}:{mutant.line}"
    change = change_of(mutant.before, mutant.after)
    told = mutant.equivalent or plainly(mutant.by)
    return MutantView(mutant, place, change, outcome, badge, told)


def _parts(bugs: Sequence[MutantView]) -> list[Part]:
    """What became of all bugs, as shares of a bar."""
    named = (
        ("survived", "let through", "missed"),
        ("caught", "caught", "caught"),
        ("equivalent", "equivalent: no user could see them, argued one by one", "equal"),
        ("stillborn", "stillborn: nothing drawn, refused by the compiler or the driver", "dead"),
        ("timeout", "so slow that the gate did not end in time", "dead"),
    )
    parts = (Part(sum(v.outcome == o for v in bugs), words, kind) for o, words, kind in named)
    return [p for p in parts if p.count]


def _controls(controls: Sequence[MutantView]) -> str:
    passed = sum(v.outcome == "passed" for v in controls)
    return f"{passed} of {len(controls)} pass" if controls else "none were tried"


def _files(bugs: Sequence[MutantView]) -> list[FileView]:
    """Those with something let through first, then by name."""
    views = []
    for name in {v.mutant.file for v in bugs}:
        own = [v for v in bugs if v.mutant.file == name]
        tally = {o: sum(v.outcome == o for v in own) for o in dict.fromkeys(v.outcome for v in own)}
        told = ", ".join(f"{n} {'let through' if o == 'survived' else o}" for o, n in tally.items())
        views.append(FileView(name, slug("attack", name), told, own))
    return sorted(
        views, key=lambda f: (not any(v.outcome == "survived" for v in f.mutants), f.name)
    )


def _chosen(attack: Attack) -> str:
    tried = sum(m.kind == "rule" for m in attack.mutants)
    if tried >= attack.generated:
        return f"all {count(tried)}"
    return f"{count(tried)} of {count(attack.generated)}, drawn with seed {attack.seed}"
