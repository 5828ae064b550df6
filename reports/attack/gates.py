"""The real gate as processes of its own, all of which can be ended at once."""

import os
import signal
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path

TIME_LIMIT = 180  # seconds; a gate takes 8, or some times that beside others
OUT_OF_TIME = -1  # also a signal's number, but nobody hangs up on a gate
TIDY = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}  # two at a time share the cores


class EndedError(Exception):
    """A gate that was ended before it gave its verdict."""


class Gates:
    """Runs gates, from several threads too."""

    def __init__(self) -> None:
        self._lock, self._ended = threading.Lock(), False
        self._running: set[subprocess.Popen] = set()

    def run(self, words: list[str], path: list[Path], folder: Path) -> tuple[int, str]:
        """The exit code (OUT_OF_TIME where it took too long) and the last line of errors.

        Args:
            path: where its packages are looked for, first to last.
            folder: that it runs in.

        Raises:
            EndedError: `end` was called.
        """
        search = {"PYTHONPATH": os.pathsep.join(map(str, path)), "PYTHONDONTWRITEBYTECODE": "1"}
        with self._lock:
            if self._ended:
                raise EndedError
            process = subprocess.Popen(
                [sys.executable, "-m", "reports.cli", *words],
                cwd=folder,
                env=os.environ | TIDY | search,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
                start_new_session=True,  # Ctrl-C is for us, and its own children end with it
            )
            self._running.add(process)
        try:
            _, errors = process.communicate(timeout=TIME_LIMIT)
        except subprocess.TimeoutExpired:
            return OUT_OF_TIME, f"took more than {TIME_LIMIT} s"
        finally:
            with self._lock:
                self._running.discard(process)
            _kill(process)
        if self._ended:
            raise EndedError
        lines = errors.strip().splitlines()
        return process.returncode, lines[-1] if lines else ""

    def end(self) -> None:
        """Kill those that run, and start no other."""
        with self._lock:
            self._ended = True
            for process in self._running:
                _kill(process, wait=False)


def _kill(process: subprocess.Popen, wait: bool = True) -> None:
    """End a process that has not ended, with all that it started."""
    if process.poll() is None:
        with suppress(ProcessLookupError):  # it has just ended
            os.killpg(process.pid, signal.SIGKILL)
        if wait:
            process.communicate()
