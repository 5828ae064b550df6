"""What makes a reference: our code, apart from its comments and layout, and the path tracer."""

import ast
import hashlib
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
# What turns the inputs into a picture; a change in any of these is another maker.
SOURCES = ("mixture.py", "physical.py", "scene_dict.py", "truths.py", "transport.py", "settings.py")
SOURCES += ("caustics.py", "energy.py", "sampling.py", "varying.py", "anisotropic.py")
SOURCES += ("../scenes/mesh.py", "../scenes/environment.py")
SOURCES += ("../scenes/surface.py", "../scenes/tangents.py", "../scenes/texture.py")
PACKAGES = ("mitsuba", "drjit")


@cache
def maker(room: Path = HERE) -> dict[str, str]:
    """The digest of the code in a copy of this folder, and the path tracer's versions."""
    code = hashlib.sha256()
    for name in SOURCES:
        text = (room / name).read_text(encoding="utf-8")
        code.update(f"{name} {code_digest(text)}\n".encode())
    return {"code": code.hexdigest(), **{name: _version(name) for name in PACKAGES}}


def code_digest(text: str) -> str:
    """SHA-256 (hex) of what Python code does: without comments, docstrings and layout."""
    return hashlib.sha256(repr(_bare(ast.parse(text))).encode()).hexdigest()


def _bare(node: Any) -> Any:
    """A syntax tree as nested lists.

    Not by `ast.dump`, which writes empty fields in some versions of Python and not in others.
    """
    if isinstance(node, list):
        return [_bare(child) for child in node]
    if not isinstance(node, ast.AST):
        return node
    fields = {name: value for name, value in ast.iter_fields(node) if value not in (None, [])}
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    if isinstance(node, documented) and ast.get_docstring(node, clean=False) is not None:
        fields["body"] = node.body[1:]
    if isinstance(node, ast.JoinedStr):  # Python 3.12 ends some formats with an empty string
        fields["values"] = [v for v in node.values if getattr(v, "value", None) != ""]
    return [type(node).__name__, [[name, _bare(value)] for name, value in fields.items()]]


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "none"  # a machine that only reads references
