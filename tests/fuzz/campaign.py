"""Many inputs, one after another: what became of each, and what must not have."""

import shutil
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from tests.fuzz.corpus import corpus, fill, lay
from tests.fuzz.inputs import Input, lay_input
from tests.fuzz.supervisor import Ended, Supervisor

DRAWN_BY = ("paper", "sampled@4")  # in turn


@dataclass
class Tally:
    """What a campaign found.

    Attributes:
        counts: by kind and by how it ended ("taken", "drawn", "refused", "wrong").
        wrong: inputs that ended as none may, and how.
        lines: what was refused with, by kind.
        slowest, hungriest: the ten inputs that took most, first the worst.
    """

    counts: Counter = field(default_factory=Counter)
    wrong: list[tuple[Input, Ended]] = field(default_factory=list)
    lines: list[tuple[str, str, str]] = field(default_factory=list)
    slowest: list[tuple[float, int, str, str]] = field(default_factory=list)
    hungriest: list[tuple[float, int, str, str]] = field(default_factory=list)

    def add(self, given: Input, ended: Ended, drawn: bool) -> None:
        """Count one input."""
        how = "refused" if ended.code == 2 else "drawn" if drawn else "taken"
        self.counts[given.kind, "wrong" if ended.problems else how] += 1
        if ended.problems:
            self.wrong.append((given, ended))
        elif ended.code == 2:
            self.lines.append((given.kind, given.how, ended.line))
        told = (given.number, given.kind, given.how)
        self.slowest = sorted([*self.slowest, (ended.seconds, *told)], reverse=True)[:10]
        self.hungriest = sorted([*self.hungriest, (ended.grew / 2**20, *told)], reverse=True)[:10]


def campaign(seed: int, numbers: range, keep: Path, kind: str = "") -> Tally:
    """Run inputs by number; the folders of those that end wrong stay in `keep`.

    Args:
        kind: of the inputs to run; all if empty.
    """
    tally = Tally()
    with tempfile.TemporaryDirectory() as place, Supervisor() as supervisor:
        base, files = Path(place), corpus()
        (valid := base / "valid").mkdir()
        lay(valid, files)
        fill(valid, base / "references")
        for number in numbers:
            folder = base / str(number)
            folder.mkdir()
            given = lay_input(seed, number, files, base / "references", folder)
            if kind not in ("", given.kind):
                shutil.rmtree(folder)
                continue
            ended = supervisor.run(given.words, given.watched)
            drawn = bool(given.drawn and ended.code == 0 and not ended.problems)
            if drawn:
                picture = supervisor.run(["!draw", given.drawn, DRAWN_BY[number % 2]])
                ended.problems += picture.problems
                ended.seconds = max(ended.seconds, picture.seconds)
                ended.grew = max(ended.grew, picture.grew)
            tally.add(given, ended, drawn)
            if ended.problems:
                shutil.copytree(folder, keep / str(number), symlinks=True, ignore=_devices)
            shutil.rmtree(folder)
    return tally


def _devices(folder: str, names: list[str]) -> list[str]:
    return [name for name in names if (Path(folder) / name).is_fifo()]
