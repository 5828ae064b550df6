"""How the command ends: every failure that is not a verdict in one line and exit code 2."""

import os
import signal
import sys
import traceback
from typing import NoReturn

from rich.console import Console

from reports.cli.app import app
from scenes.errors import InputError


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
        app()
    except InputError as error:
        _fail(str(error))
    except OSError as error:
        _fail(f"{error.filename or 'output'}: {error.strerror}")
    except Exception as error:
        if asked:  # an interrupted import fails as it likes
            _interrupted()
        traceback.print_exc()
        _fail(f"this is a bug in shadeproof: {type(error).__name__}: {error}")
    except (SystemExit, KeyboardInterrupt):
        if asked:
            _interrupted()
        raise


def _fail(text: str) -> NoReturn:
    Console(stderr=True, highlight=False).print(f"error: {text}", markup=False, soft_wrap=True)
    sys.exit(2)


def _interrupted() -> NoReturn:
    print("interrupted; finished batches are kept, run again to go on", file=sys.stderr, flush=True)
    os._exit(130)  # the libraries' own exit hooks would talk over this
