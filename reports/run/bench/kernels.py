"""Dr.Jit's compiled kernels: kept apart from the user's, so that a first start can be measured."""

import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import util
from pathlib import Path

VARIABLE = "DRJIT_CACHE_DIR"
_own: list[tempfile.TemporaryDirectory] = []


@contextmanager
def kept_apart() -> Iterator[None]:
    """Give Dr.Jit a folder of its own for kernels; too late where it has been loaded already.

    Then what stands in the user's cache shortens the compilation that is told. The folder stays
    until Python ends, and that of the fork server. A command that the user interrupts ends without
    Python's exit hooks (reports/cli/main.py), so here both are removed.
    """
    if not _own and "drjit" not in sys.modules:
        _own.append(tempfile.TemporaryDirectory(prefix="shadeproof-kernels-"))
        os.environ[VARIABLE] = _own[0].name
    try:
        yield
    except KeyboardInterrupt:
        for folder in (*(own.name for own in _own), util.get_temp_dir()):
            shutil.rmtree(folder, ignore_errors=True)
        raise


def forget() -> None:
    """Forget every kernel of this process, those on disk too if they are its own."""
    import drjit as dr

    dr.flush_kernel_cache()
    for folder in _own:
        for kernel in Path(folder.name).iterdir():
            kernel.unlink()
