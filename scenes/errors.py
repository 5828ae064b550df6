"""The one exception for mistakes that a user can mend."""

from pathlib import Path

LONGEST = 400  # characters of one part of a message


class InputError(Exception):
    """A file, field or setting that the harness cannot use; ends in one line and exit code 2.

    Args:
        where: the file (or command-line option) at fault.
        field: the field, object or line within it; may be empty.
        problem: what is wrong with it.
        remedy: what would be right.
    """

    def __init__(self, where: str | Path, field: str, problem: str, remedy: str) -> None:
        parts = (str(where), field, problem, remedy)
        self.where, self.field, self.problem, self.remedy = map(one_line, parts)
        place = f"{self.where}: {self.field}" if self.field else self.where
        super().__init__(f"{place}: {self.problem}; {self.remedy}")

    def __reduce__(self) -> tuple:
        """Pickled by its four parts, so that it comes back whole from another process."""
        return type(self), (self.where, self.field, self.problem, self.remedy)


def one_line(text: str) -> str:
    """Text that may stand in a terminal, whatever a file's name or a library's message holds.

    Line breaks become spaces, what cannot be printed (or turns the writing's direction) becomes
    its escape, and of a long text the middle is left out.
    """
    text = " ".join(text.split())
    if len(text) > LONGEST:
        text = f"{text[: LONGEST // 2]} ... {text[-LONGEST // 2 :]}"
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)
