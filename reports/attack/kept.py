"""What an attack has found so far, beside attack.json, so that one that is interrupted goes on."""

import hashlib
import json
from pathlib import Path

from pydantic import ValidationError

from reports.attack.mutants import RENDERER
from reports.attack.results import Mutant
from scenes.frame import sha256

ROOMS = ("renderer", "reports", "reference", "scenes")
NOT_SOURCES = {"__pycache__", "out"}
STORE = Path("reports/references")  # of this checkout


class Kept:
    """Verdicts as they come, a line each, under the digest of all that they depend on.

    Args:
        folder: that attack.json will be in.
        about: the suite, the store and whatever else the verdicts depend on.
    """

    def __init__(self, folder: Path, about: dict) -> None:
        self.path, self._key = folder / "attack.partial.jsonl", _digest(about)

    def read(self) -> dict[str, Mutant]:
        """The verdicts by name; none where the sources have changed since."""
        try:
            key, *lines = self.path.read_text(encoding="utf-8").splitlines()
        except (OSError, ValueError):
            return {}
        found: dict[str, Mutant] = {}
        for line in lines if key == self._key else ():
            try:
                mutant = Mutant.model_validate_json(line)
            except ValidationError:  # half a line: the machine went down
                break
            found[mutant.id] = mutant
        return found

    def begin(self, mutants: dict[str, Mutant]) -> None:
        """Write anew what is known."""
        lines = [self._key, *(m.model_dump_json() for m in mutants.values())]
        self.path.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")

    def add(self, mutant: Mutant) -> None:
        """Keep one more."""
        with self.path.open("a", encoding="utf-8") as file:
            file.write(mutant.model_dump_json() + "\n")

    def remove(self) -> None:
        """All is in attack.json."""
        self.path.unlink(missing_ok=True)


def _digest(about: dict) -> str:
    """Of every file of the four rooms, and of `about`."""
    root = RENDERER.parent
    files = {
        str(path.relative_to(root)): sha256(path)
        for room in ROOMS
        for path in sorted((root / room).rglob("*"))
        if path.is_file()
        and not NOT_SOURCES & set(path.relative_to(root).parts)
        and root / STORE not in path.parents
    }
    return hashlib.sha256(json.dumps([files, about], sort_keys=True).encode()).hexdigest()
