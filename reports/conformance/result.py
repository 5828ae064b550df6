"""What one check of conformance found."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Conformance:
    """The worst difference of one kind between the renderer and a definition.

    Attributes:
        name: what was checked.
        off: the difference, in the unit of `allowed`; NaN fails.
        allowed: what it may be; reports/run/conformance/shared.py gives the reasons.
        place: where it is found.
    """

    name: str
    off: float
    allowed: float
    place: str

    @property
    def passed(self) -> bool:
        """Whether it is within what is allowed."""
        return self.off <= self.allowed
