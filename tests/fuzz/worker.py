"""A process that runs the command again and again, and tells how each run ended.

    python -m tests.fuzz.worker [bare]    reads one JSON order a line, answers one JSON line each

One order is a run: `words` are the command's arguments, or start with "!" and a name of `ALSO`.
What the run writes, C libraries' chatter too, is caught at the file descriptors. A bare worker
starts sooner, and loads the renderer when it is asked for.
"""

import contextlib
import json
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import numpy as np


def main() -> None:
    """Answer orders until the input ends."""
    asked, answers = os.fdopen(os.dup(0)), os.fdopen(os.dup(1), "w", buffering=1)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if sys.argv[1:] != ["bare"]:
        _warm_up()
    print(json.dumps("ready"), file=answers)
    for line in asked:
        print(json.dumps(_answer(json.loads(line))), file=answers)


def _answer(words: list[str]) -> dict:
    Path("/proc/self/clear_refs").write_text("5")  # the peak counts from here
    before, start = _status("VmRSS"), time.perf_counter()
    with tempfile.TemporaryFile() as err:
        with _caught(err):
            code = _run(words)
        err.seek(0)
        said = err.read().decode(errors="backslashreplace")
    return {
        "code": code,
        "seconds": time.perf_counter() - start,
        "grew": max(_status("VmHWM") - before, 0),
        "held": _status("VmRSS"),
        "err": said[-4000:],
    }


def _run(words: list[str]) -> int:
    """Run the command, or what else is asked for; its exit code."""
    from reports.cli import main as shadeproof

    call = shadeproof
    if words[0].startswith("!"):
        call, words = ALSO[words[0][1:]], words[1:]
    sys.argv = ["shadeproof", *words]
    try:
        call()
    except SystemExit as end:
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    except Exception:
        traceback.print_exc()
        return 1
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
    return 0


def _draw() -> None:
    """Draw a suite's first case by a technique, small; fail where a pixel is no light."""
    from renderer.draw import Renderer
    from renderer.techniques import technique
    from scenes.suite import expand, load_suite

    case = expand(*load_suite(sys.argv[1]))[0].case.model_copy(update={"width": 24, "height": 18})
    name = sys.argv[2]
    if technique(name).cannot_draw(case.model, [o.material for o in case.objects]):
        return
    rgb = Renderer(technique(name), repeats=0).render(case).rgb
    if not (light := np.isfinite(rgb) & (rgb >= 0)).all():
        bad = np.argwhere(~light)[0]
        sys.exit(f"{name} draws {rgb[tuple(bad)]} at row, column, channel {bad.tolist()}")


def _crosscheck() -> None:
    """The one program of ours that reads a case's JSON."""
    from reports.crosscheck.__main__ import main as crosscheck

    sys.exit(crosscheck())


def _raises() -> None:
    raise KeyError("planted")


def _hangs() -> None:
    time.sleep(3600)


def _crashes() -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


def _hungers() -> None:
    np.ones(100 << 20, np.uint8)


def _devours() -> None:
    held = []
    while len(held) < 20:
        held.append(np.ones(20 << 20, np.uint8))
        time.sleep(0.05)


def _leaves_half() -> None:
    """Write half a result, then refuse."""
    (Path(sys.argv[1]) / "results.json").write_text('{"schema')
    print("error: a.toml: field: is wrong; mend it", file=sys.stderr)
    sys.exit(2)


def _deletes() -> None:
    """Take away what is not ours to take, then refuse."""
    (Path(sys.argv[1]) / "scene.toml").unlink()
    print("error: a.toml: field: is wrong; mend it", file=sys.stderr)
    sys.exit(2)


def _mumbles() -> None:
    print("error: invalid literal\nfor int()", file=sys.stderr)
    sys.exit(2)


PLANTED = {
    "raises": _raises,
    "hangs": _hangs,
    "crashes": _crashes,
    "hungers": _hungers,
    "devours": _devours,
    "leaves-half": _leaves_half,
    "deletes": _deletes,
    "mumbles": _mumbles,
}
ALSO = {"draw": _draw, "crosscheck": _crosscheck, **PLANTED}


@contextlib.contextmanager
def _caught(err: IO[bytes]) -> Iterator[None]:
    """Point the descriptor of stderr at a file, that of stdout at nothing."""
    kept, nothing = (os.dup(1), os.dup(2)), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    os.dup2(err.fileno(), 2)
    os.close(nothing)
    try:
        yield
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        for place, descriptor in zip((1, 2), kept, strict=True):
            os.dup2(descriptor, place)
            os.close(descriptor)


def _warm_up() -> None:
    """Import what every run needs, and make the context, so that no input is charged for it."""
    import reports.run.suite  # noqa: F401  loaded ahead of the first input
    from renderer.context import device
    from scenes.mesh import load_mesh

    device()
    load_mesh("sphere")


def memory(process: int, name: str) -> int:
    """A line of a process's memory in /proc, such as VmRSS, in bytes; 0 if it is gone."""
    with contextlib.suppress(OSError):
        for line in Path(f"/proc/{process}/status").read_text().splitlines():
            if line.startswith(f"{name}:"):
                return int(line.split()[1]) * 1024
    return 0


def _status(name: str) -> int:
    return memory(os.getpid(), name)


if __name__ == "__main__":
    main()
