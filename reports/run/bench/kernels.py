"""Dr.Jit's compiled kernels: kept apart from the user's, so that a first start can be measured."""

import os
import sys
import tempfile
from pathlib import Path

VARIABLE = "DRJIT_CACHE_DIR"
_own: list[tempfile.TemporaryDirectory] = []


def keep_apart() -> None:
    """Give Dr.Jit a folder of its own for kernels; too late where it has been loaded already.

    Then what stands in the user's cache shortens the compilation that is told.
    """
    if not _own and "drjit" not in sys.modules:
        _own.append(tempfile.TemporaryDirectory(prefix="shadeproof-kernels-"))
        os.environ[VARIABLE] = _own[0].name


def forget() -> None:
    """Forget every kernel of this process, those on disk too if they are its own."""
    import drjit as dr

    dr.flush_kernel_cache()
    for folder in _own:
        for kernel in Path(folder.name).iterdir():
            kernel.unlink()
