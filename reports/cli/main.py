"""How the command ends: every failure that is not a verdict in one line and exit code 2."""

import os
import signal
import sys
import traceback
from typing import NoReturn

import typer
from pydantic import ValidationError
from rich.console import Console

from reports.cli.app import app, when_interrupted
from scenes.errors import InputError
from scenes.words import SEE, first_mistake

# By package, the extra that brings it.
EXTRAS = {"moderngl": "renderer", "mitsuba": "reference", "drjit": "reference"}
EXTRAS |= {"moderngl_window": "window"}
# What a comparison does without them.
INSTEAD = {"renderer": ", or give a --candidate", "reference": ", or give --truth or --frozen"}


def main() -> None:
    """Entry point: every failure that is not a verdict ends in one line and exit code 2."""
    asked = False

    def stop(*_: object) -> None:
        nonlocal asked
        asked = True
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, stop)
    signal.signal(signal.SIGTERM, stop)  # CI's cancel ends like Ctrl-C
    try:
        code = app(
            prog_name="shadeproof", standalone_mode=False
        )  # which raises what the parser refuses
    except InputError as error:
        _fail(str(error))
    except typer.TyperException as error:
        if error.format_message():
            _fail(str(_refused(error)))
        sys.exit(2)  # a group without a command: its help is told
    except OSError as error:
        problem = f"cannot be used ({error.strerror or error})"
        remedy = "check the path, its permissions and the room on its disk"
        _fail(str(InputError(error.filename or "output", "", problem, remedy)))
    except MemoryError:
        remedy = "take smaller pictures, meshes or environments, or a larger machine"
        _fail(str(InputError("memory", "", "there is not enough of it", remedy)))
    except Exception as error:
        if isinstance(error, ModuleNotFoundError) and (lack := _lacking(error)):
            _fail(str(lack))
        if asked:  # an interrupted import fails as it likes
            _interrupted()
        traceback.print_exc()
        _fail(f"this is a bug in shadeproof: {type(error).__name__}: {error}")
    except (SystemExit, KeyboardInterrupt):
        if asked:
            _interrupted()
        raise
    if asked:
        _interrupted()
    sys.exit(code)


def _refused(error: typer.TyperException) -> InputError:
    """What the parser of options refuses, as every user's mistake is told."""
    context, parameter = getattr(error, "ctx", None), getattr(error, "param", None)
    command = context.command_path if context else "shadeproof"
    remedy = f"see `{command} --help`"
    if parameter is None:
        problem = error.format_message().rstrip(".")
        return InputError(command, "", problem[:1].lower() + problem[1:], remedy)
    where = max(parameter.opts, key=len)
    if isinstance(error.__cause__, ValidationError):
        _, problem, right = first_mistake(error.__cause__)
        return InputError(where, "", problem.rstrip("."), remedy if right == SEE else right)
    return InputError(where, "", (error.message or "is missing").rstrip("."), remedy)


def _lacking(error: ModuleNotFoundError) -> InputError | None:
    """A package of an extra that is not installed, told with its remedy; None for any other."""
    package = (error.name or "").partition(".")[0]
    if package not in EXTRAS:
        return None
    remedy = f"install it with the extra: pip install 'path/to/shadeproof[{EXTRAS[package]}]'"
    if sys.argv[1:2] in (["compare"], ["gate"]):
        remedy += INSTEAD[EXTRAS[package]]
    return InputError("package", package, "is not installed", remedy)


def _fail(text: str) -> NoReturn:
    Console(stderr=True, highlight=False).print(f"error: {text}", markup=False, soft_wrap=True)
    sys.exit(2)


def _interrupted() -> NoReturn:
    print(f"interrupted; {when_interrupted[-1]}", file=sys.stderr, flush=True)
    os._exit(130)  # the libraries' own exit hooks would talk over this
