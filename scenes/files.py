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
        problem = f"{_no_file(places[0])}: {repr(str(places[0]))[1:-1]}"
        remedy = "check the path" if Path(name).is_absolute() else f"a path starts at {home}"
        raise InputError(where, field, problem, remedy)
    known = [*primitives, *sorted({p.stem for e in endings for p in shelf.glob(f"*{e}")})]
    remedy = f"use one of {', '.join(known)}, or a path that ends in {' or '.join(endings)}"
    raise InputError(where, field, f"unknown name {reprlib.repr(name)}", remedy)


def checked_file(path: Path, remedy: str = "check the path", field: str = "") -> Path:
    """The path, if a file lies there: a pipe or a device might never end.

    Raises:
        InputError: there is none, or it is something else.
    """
    if problem := _no_file(path):
        raise InputError(path, field, problem, remedy)
    return path


def _no_file(path: Path) -> str:
    """Why a path is that of no file; empty if it is one."""
    try:
        if path.is_file():
            return ""
        found, folder = path.exists(), path.is_dir()
    except (OSError, ValueError):  # folders that may not be entered; names that no file can have
        return "no such file"
    return "is a folder" if folder else "is no file" if found else "no such file"


def read_text(path: Path, remedy: str = "check the path") -> str:
    """Read a text file.

    Args:
        remedy: what to do where there is none.

    Raises:
        InputError: it is missing, cannot be read or is not UTF-8.
    """
    try:
        content = checked_file(path, remedy).read_bytes()
    except OSError as error:
        raise InputError(path, "", f"cannot be read ({error.strerror})", remedy) from error
    try:
        return content.decode()
    except UnicodeDecodeError as error:
        line = 1 + content.count(b"\n", 0, error.start)
        problem = f"is no text in UTF-8 (line {line})"
        raise InputError(path, "", problem, "save it as UTF-8") from error


def read_toml(path: Path) -> dict[str, Any]:
    """Parse a TOML file.

    Raises:
        InputError: it is missing or not TOML.
    """
    text = read_text(path)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        problem = f"is not TOML ({error})"
    except ValueError:  # Python converts no more than 4,300 digits
        problem = "is not TOML (a number has thousands of digits)"
    except RecursionError:
        problem = "is not TOML (brackets in brackets, too deep)"
    raise InputError(path, "", problem, "mend the syntax")


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
        by = f" (as changed by {user.name}: {at})" if user else ""
        raise _mistake(error, kind, path, by) from error


def read_json(kind: type[Record], path: Path) -> Record:
    """Read a record that was written as JSON, such as a case.

    Raises:
        InputError: it is missing, is not JSON, or a field does not validate.
    """
    try:
        return kind.model_validate_json(read_text(path))
    except ValidationError as error:
        raise _mistake(error, kind, path) from error


def _mistake(error: ValidationError, kind: type[BaseModel], path: Path, by: str = "") -> InputError:
    field, problem, remedy = first_mistake(error, kind)
    return InputError(path, f"{field or kind.__name__.lower()}{by}", problem, remedy)
