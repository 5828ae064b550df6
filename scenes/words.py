"""What a validator refuses, in the words of someone who writes the file or the option."""

import reprlib
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any

from pydantic import BaseModel, ValidationError

FIELDS = "scenes/FORMAT.md lists the fields"
SEE = "see scenes/FORMAT.md"  # where no remedy is known
# By pydantic's type of a mistake, what would be right; braces hold its context.
REMEDIES = {
    "string_type": "write text in quotes",
    "path_type": "write a path in quotes",
    "bool_type": "write true or false",
    "bool_parsing": "write true or false",
    "int_type": "give a whole number",
    "int_parsing": "give a whole number",
    "int_from_float": "give a whole number",
    "float_type": "give a number",
    "float_parsing": "give a number",
    "finite_number": "give a finite number",
    "greater_than": "give a number greater than {gt:g}",
    "greater_than_equal": "give a number from {ge:g} up",
    "less_than": "give a number less than {lt:g}",
    "less_than_equal": "give a number up to {le:g}",
    "literal_error": "use {expected}",
    "tuple_type": "give a list",
    "list_type": "give a list",
    "dict_type": "give a table of fields",
    "model_type": "give a table of fields",
    "model_attributes_type": "give a table of fields",
    "too_short": "give a list of at least {min_length}",
    "too_long": "give a list of up to {max_length}",
}


class _Toml(reprlib.Repr):
    """Values as TOML writes them, cut short; reprlib finds the method by the type's name."""

    def repr_bool(self, value: bool, level: int) -> str:
        return str(value).lower()

    def repr_int(self, value: int, level: int) -> str:
        # Python writes no more than 4,300 digits, and nobody reads them.
        return str(value) if abs(value) < 10**40 else "a number of over 40 digits"

    def repr_NoneType(self, value: None, level: int) -> str:  # of JSON; TOML has none
        return "null"

    def repr_date(self, value: Any, level: int) -> str:
        return str(value)

    repr_datetime = repr_time = repr_date


show = _Toml().repr


def nearest(name: str, known: Iterable[str]) -> str:
    """What somebody may have meant, as a remedy's first words; "" if nothing is like it."""
    found = get_close_matches(name, known, 3, 0.5)
    return f"is it {' or '.join(repr(n) for n in found)}? " if found else ""


def first_mistake(error: ValidationError, kind: type[BaseModel] | None = None) -> tuple[str, ...]:
    """The first mistake that a validator found: its field, what is wrong, what would be right.

    Where a field may be one of several kinds, the mistake is told within the kind that was
    begun, or else all the kinds are.

    Args:
        kind: the record that was validated, whose fields are named if one is unknown.
    """
    mistakes = [(_field(m["loc"]), m) for m in error.errors(include_url=False)]
    field = mistakes[0][0]
    about = [(f, m) for f, m in mistakes if f[: len(field)] == field]
    field = max((f for f, _ in about), key=len)
    told = [_in_words(m, kind) for f, m in about if f == field]
    remedies = " or ".join(dict.fromkeys(remedy for _, remedy in told))
    return ".".join(field), told[0][0], remedies.replace(" or give ", " or ")


def _field(place: tuple[int | str, ...]) -> tuple[str, ...]:
    """Where it is, without the names of a union's members, which stand in `loc` too."""
    parts = [str(p) for p in place if isinstance(p, int) or p.isidentifier()]
    return tuple(p for p in parts if p != "str")


def _in_words(mistake: Any, kind: type[BaseModel] | None) -> tuple[str, str]:
    """What is wrong and what would be right; our own checks say both, parted by '; '."""
    cause, place, value = mistake["type"], mistake["loc"], mistake["input"]
    if cause == "extra_forbidden":
        known = kind and len(place) == 1
        remedy = f"use one of {', '.join(sorted(kind.model_fields))}" if known else FIELDS
        name = str(place[-1])  # told with its place, unless it is no name at all
        return "unknown field" + ("" if name.isidentifier() else f" {show(name)}"), remedy
    if cause == "missing":
        return "is missing", f"add it; {FIELDS}"
    if cause == "json_invalid":
        return "is not JSON", "write it anew"
    if cause == "value_error":
        told = mistake["msg"].removeprefix("Value error, ")
        problem, parted, remedy = told.rpartition("; ")  # a value told in the problem may hold one
        return (problem, remedy) if parted else (told, SEE)
    problem = f"{show(value)} does not fit"
    if cause == "tuple_type" and isinstance(value, dict) and len(place) == 1:
        return problem, f"give a list: [...], or [[{place[0]}]] where it holds tables"
    remedy = REMEDIES.get(cause)
    if cause == "too_long" and mistake["ctx"].get("field_type") == "Tuple":
        remedy = "give a list of {max_length}"  # no fewer either
    return problem, remedy.format(**mistake.get("ctx", {})) if remedy else SEE
