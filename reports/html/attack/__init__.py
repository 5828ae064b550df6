"""The gate under attack and its limits: attack.html, and the same sections in report.html."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reports.attack.results import load_attack
from reports.html.attack.limits import LimitsView, limits_view
from reports.html.attack.view import AttackView, attack_view
from reports.html.template import render
from reports.limits.results import load_limits
from scenes.errors import InputError
from scenes.frame import write_text

__all__ = ["GateView", "gate_of", "write_page"]


@dataclass(frozen=True)
class GateView:
    """What the gate sees: each a view, why it cannot be shown, or None where there is none."""

    attack: AttackView | str | None
    limits: LimitsView | str | None

    @property
    def headline(self) -> str:
        """The score, and false alarms where there are any or no score."""
        said = []
        if isinstance(self.attack, AttackView):
            said.append(self.attack.headline)
        if isinstance(self.limits, LimitsView) and (not said or self.limits.state == "fail"):
            said.append(self.limits.sentence)
        return ". ".join(said) or "What the gate can see was not measured"

    @property
    def state(self) -> str:
        """A class for its colour."""
        shown = [v for v in (self.attack, self.limits) if v is not None]
        return "fail" if any(isinstance(v, str) or v.state == "fail" for v in shown) else "pass"


def write_page(folder: Path) -> Path:
    """Write `folder`/attack.html of the attack.json and limits.json there, whole or not at all.

    Raises:
        InputError: the folder cannot be written.
    """
    path = folder / "attack.html"
    gate = gate_of(folder) or GateView(None, None)
    write_text(path, render("attack.html.j2", gate=gate))
    return path


def gate_of(folder: Path) -> GateView | None:
    """What `folder`/attack.json and limits.json show; None where neither is there."""
    attack = _shown(folder / "attack.json", load_attack, attack_view)
    limits = _shown(folder / "limits.json", load_limits, limits_view)
    return GateView(attack, limits) if attack or limits else None


def _shown(path: Path, load: Callable[[Path], Any], view: Callable[[Any], Any]) -> Any:
    """A record's view; why it cannot be shown; None where there is none."""
    if not path.exists():
        return None
    try:
        return view(load(path))
    except InputError as error:
        return str(error)
