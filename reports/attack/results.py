"""attack.json: what was done to copies of the renderer, and what the gate said of each."""

from pathlib import Path
from typing import Any, Literal

from reports.record import Record, load, save
from reports.results import Figure

SCHEMA_VERSION = 1
Kind = Literal["rule", "realistic", "control"]
Outcome = Literal["caught", "survived", "stillborn", "timeout", "passed", "alarm"]


class Mutant(Record):
    """One change of one file of the renderer, and the verdict of the gate on what it then draws.

    Attributes:
        id: names it for `shadeproof attack --only`.
        kind: made by rule, a realistic bug, or a control: a rewrite that changes nothing.
        rule: of `reports.attack.rules`; "" for what was written by hand.
        file: relative to the folder renderer/.
        line: where the change begins, from 1.
        before, after: the text that was replaced, and by what.
        words: what the change is, in a few words.
        outcome: `caught` where the gate failed, `survived` where it passed, `stillborn` where
            nothing was drawn (it does not compile, raises or crashes), `timeout` where the gate
            ran out of time; of a control `passed` or `alarm`.
        exit_code: of the gate; -1 where it ran out of time.
        by: the row or check that failed worst and its figure, or the message of what is stillborn.
        seconds: of the whole process.
        equivalent: why no user could see the change, of a survivor that was argued; else "".
    """

    id: str
    kind: Kind
    rule: str = ""
    file: str
    line: int
    before: str
    after: str
    words: str = ""
    outcome: Outcome
    exit_code: int
    by: str = ""
    seconds: Figure
    equivalent: str = ""


class Attack(Record):
    """One attack on the gate.

    Attributes:
        seed: of the choice among the mutants by rule.
        generated: how many mutants by rule there are to choose from.
    """

    schema_version: Literal[1] = SCHEMA_VERSION
    created: str
    seconds: Figure
    command: str
    suite: str
    seed: int
    generated: int
    provenance: dict[str, Any]
    mutants: list[Mutant]

    def having(self, *outcomes: Outcome) -> list[Mutant]:
        """The mutants with one of these outcomes."""
        return [m for m in self.mutants if m.outcome in outcomes]

    @property
    def unexplained(self) -> list[Mutant]:
        """Survivors that no argument calls equivalent."""
        return [m for m in self.having("survived") if not m.equivalent]

    @property
    def alarms(self) -> list[Mutant]:
        """Controls that the gate did not pass."""
        return [m for m in self.mutants if m.kind == "control" and m.outcome != "passed"]

    @property
    def passed(self) -> bool:
        """Whether all was caught that a user could see, and every control was passed."""
        return not self.unexplained and not self.alarms


def save_attack(attack: Attack, path: Path) -> None:
    """Write attack.json whole or not at all."""
    save(attack, path)


def load_attack(path: Path) -> Attack:
    """Read an attack.json; see `reports.record.load`."""
    return load(Attack, path, f"attack.json of schema {SCHEMA_VERSION}", "shadeproof attack")
