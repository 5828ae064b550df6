"""How the files of a suite name one another, and how their fields are read and checked."""

import reprlib
import tomllib
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from scenes.errors import InputError
from scenes.words import first_mistake

Record = TypeVar("Record", bound=BaseModel)


def find(
    name: str,
    shelf: Path,
    endings: tuple[str, ...],
    home: Path,
    where: str | Path,
    field: str,
    primitives: tuple[str, ...] = (),
) -> Path:
    """A file by its name on our own shelf, or by a path relative to the file that names it.

    Args:
        name: with one of `endings` a path, without one a name on the shelf.
        shelf: our own folder of such files.
        home: the folder where a relative path starts.
        where, field: the file and field that name it, for the message.
        primitives: further names that would be right, for the message.

    Raises:
        InputError: there is no such file.
    """
    by_path = Path(name).suffix.lower() in endings
    places = [home / name] if by_path else [shelf / f"{name}{ending}" for ending in endings]
    for path in places:
        try:
            if path.is_file():
                return path.resolve()
        except (OSError, ValueError):  # a name too long, or one that no file can have
            break
    if by_path:
        problem = f"no such file: {repr(str(places[0]))[1:-1]}"
        raise InputError(where, field, problem, f"a path starts at {home}")
    known = [*primitives, *sorted({p.stem for e in endings for p in shelf.glob(f"*{e}")})]
    remedy = f"use one of {', '.join(known)}, or a path that ends in {' or '.join(endings)}"
    raise InputError(where, field, f"unknown name {reprlib.repr(name)}", remedy)


def read_toml(path: Path) -> dict[str, Any]:
    """Parse a TOML file.

    Raises:
        InputError: it is missing or not TOML.
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        problem = f"cannot be read ({error.strerror})"
        raise InputError(path, "", problem, "check the path") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise InputError(path, "", f"is not TOML ({error})", "mend the syntax") from error


def parse(
    kind: type[Record], fields: dict[str, Any], path: Path, user: Path | None = None, at: str = ""
) -> Record:
    """Validate fields into `kind`; the first mistake becomes one InputError that names it.

    Args:
        path: the file that the fields come from.
        user: the file whose changes were laid over them, named when the mistake may be there.
        at: where in `user` those changes stand.
    """
    try:
        return kind.model_validate(fields)
    except ValidationError as error:
        field, problem, remedy = first_mistake(error, kind)
        field = field or kind.__name__.lower()
        place = f"{field} (as changed by {user.name}: {at})" if user else field
        raise InputError(path, place, problem, remedy) from error
