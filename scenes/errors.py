"""The one exception for mistakes that a user can mend."""

from pathlib import Path


class InputError(Exception):
    """A file, field or setting that the harness cannot use; ends in one line and exit code 2.

    Args:
        where: the file (or command-line option) at fault.
        field: the field, object or line within it; may be empty.
        problem: what is wrong with it.
        remedy: what would be right.
    """

    def __init__(self, where: str | Path, field: str, problem: str, remedy: str) -> None:
        self.where, self.field, self.problem, self.remedy = str(where), field, problem, remedy
        place = f"{where}: {field}" if field else str(where)
        # A name or a library's message may hold line breaks; what ends in a terminal may not.
        super().__init__(" ".join(f"{place}: {problem}; {remedy}".split()))

    def __reduce__(self) -> tuple:
        """Pickled by its four parts, so that it comes back whole from another process."""
        return type(self), (self.where, self.field, self.problem, self.remedy)
