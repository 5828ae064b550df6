"""Records that stages leave on disk as JSON: written whole, read with every field checked."""

from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from scenes.errors import InputError
from scenes.files import read_text
from scenes.frame import write_text
from scenes.words import first_mistake


class Record(BaseModel):
    """A part of such a file; unknown fields are refused."""

    model_config = ConfigDict(extra="forbid")


Whole = TypeVar("Whole", bound=Record)


def save(record: Record, path: Path) -> None:
    """Write a record whole or not at all."""
    write_text(path, record.model_dump_json(indent=1) + "\n")


def load(kind: type[Whole], path: Path, name: str, command: str) -> Whole:
    """Read a record.

    Args:
        name: what such files are called, with the version of their schema.
        command: what writes them.

    Raises:
        InputError: it is missing, damaged, or of another schema version.
    """
    try:
        return kind.model_validate_json(read_text(path, f"run `{command}` first"))
    except ValidationError as error:
        problem = f"is no {name} ({' '.join(first_mistake(error)[:2]).strip()})"
        raise InputError(path, "", problem, f"run `{command}` again") from error
