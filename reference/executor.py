"""Where batches are traced: in this process, or by the workers of a Dask cluster."""

import logging
from collections.abc import Callable
from concurrent.futures import CancelledError, Executor, Future
from typing import Any
from urllib.parse import urlsplit

from scenes.errors import InputError

PATIENCE = 30  # seconds to wait for a scheduler, and for its first worker
PROTOCOLS = ("tcp", "tls", "ws", "wss", "ucx", "ucxx")


class Serial(Executor):
    """One job after the other, in this process: Mitsuba itself uses every core."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future:
        """Do the job now; the future is done when it is returned."""
        future: Future = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


def check_address(address: str) -> None:
    """Refuse what cannot be a scheduler's address, before anyone waits for an answer.

    Raises:
        InputError: it has no host or no port.
    """
    try:
        parts = urlsplit(address if "://" in address else f"tcp://{address}")
        usable = parts.hostname and parts.port and parts.scheme in PROTOCOLS
    except ValueError:  # such as a port that is no number
        usable = False
    if not usable:
        remedy = "write tcp://HOST:8786, as `dask scheduler` prints it"
        raise InputError("--cluster", "", f"'{address}' is no scheduler's address", remedy)


def connect(address: str) -> Executor:
    """The workers of a Dask scheduler, such as tcp://host:8786.

    Raises:
        InputError: no address, the package is not installed, nobody answers, or there are no
            workers.
    """
    check_address(address)
    try:
        from distributed import Client
    except ImportError as error:
        remedy = "install the extra: pip install '.[cluster]'"
        raise InputError("--cluster", "", "needs the package distributed", remedy) from error
    for name in ("distributed", "distributed.client"):  # what matters, we raise
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        remedy = "start one: dask scheduler"
        raise InputError("--cluster", address, "no Dask scheduler answers", remedy) from error
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError as error:
        client.close()
        remedy = f"start some: dask worker {address} --nthreads 1"
        raise InputError("--cluster", address, "the scheduler has no workers", remedy) from error
    return client.get_executor(pure=False)


def explained(error: Exception) -> Exception:
    """The loss of a cluster's machines as a line for its user; any other failure as it is."""
    if isinstance(error, CancelledError):
        remedy = "start it and the workers again, and run again: finished batches are kept"
        return InputError("--cluster", "", "the scheduler was lost", remedy)
    if type(error).__name__ == "KilledWorker":  # distributed is not imported without a cluster
        remedy = "see their logs, and what memory they have"
        return InputError("--cluster", "", "one batch lost every worker that tried it", remedy)
    if isinstance(error, RuntimeError) and "deserialization of the task graph" in str(error):
        remedy = "start it as the workers, from a .venv made for this version: make .venv/.stamp"
        return InputError("--cluster", "", "the scheduler has not our code and packages", remedy)
    return error
