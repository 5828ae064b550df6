"""Whose code and path tracer made the references of a run."""

from dataclasses import dataclass, field

from reference.maker import PACKAGES, maker
from scenes.frame import Frame

SHORT = 12  # hex digits of a digest that are told
UNKNOWN = "unknown"


@dataclass
class Makers:
    """Gathers who made the batches that a run uses."""

    found: set[tuple[str, ...]] = field(default_factory=set)

    def add(self, batches: list[Frame]) -> None:
        """Take in the batches of one reference."""
        here = maker()["code"]  # of a batch made in this run, which the store has not told
        for frame in batches:
            told = {"code": here} | frame.provenance
            self.found.add(_who(told))

    def told(self) -> list[dict[str, str | bool]]:
        """Each maker: code (short digest), mitsuba, drjit, and whether it is `ours`.

        Where no path tracer is installed the code alone decides.
        """
        ours = _who(maker())
        return [
            dict(zip(("code", *PACKAGES), who, strict=True))
            | {"ours": all(a == b or b == "none" for a, b in zip(who, ours, strict=True))}
            for who in sorted(self.found)
        ]


def _who(told: dict) -> tuple[str, ...]:
    return (told["code"][:SHORT], *(str(told.get(name, UNKNOWN)) for name in PACKAGES))
