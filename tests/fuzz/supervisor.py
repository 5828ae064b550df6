"""Runs inputs in a worker, with a limit on time, and says what is wrong with how each ended."""

import json
import math
import os
import re
import select
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

from tests.fuzz.worker import memory

PATIENCE = 120.0  # seconds for a worker to start
TIRED = 2 << 30  # bytes held by caches after which a fresh worker goes on
LONGEST = 1000  # characters of a refusal
RESULTS = ("results.json", "report.html", "junit.xml", "summary.md")
PROGRESS = re.compile(r"\[\d+/\d+\] ")
# What a library, or Python, would say; no user can do anything with it.
INTERNAL = re.compile(
    r"\bNone\b|Errno|<class|object at 0x|NoneType|pydantic|trimesh|numpy|"
    r"OpenImageIO|OIIO|EXR_ERR|EXR Error|magic|version flags|' attribute|"
    r"\w+Error\b|codec can't|array\(|dtype"
)


@dataclass
class Ended:
    """How one run ended.

    Attributes:
        code: its exit code; None where it hung or crashed.
        line: what it refused with, of exit code 2.
        problems: all that must not be; empty where it ended well.
        grew: bytes by which the process grew at its peak.
    """

    code: int | None
    line: str = ""
    problems: list[str] = field(default_factory=list)
    seconds: float = 0.0
    grew: int = 0


class Supervisor:
    """Keeps one worker alive.

    Args:
        seconds: that one input may take.
        growth: bytes by which the worker may grow.
        danger: bytes of growth at which it is given up at once, for the machine's sake.
        mode: what the worker is started with.
    """

    def __init__(
        self,
        seconds: float = 10.0,
        growth: int = 2 << 30,
        danger: int = 6 << 30,
        mode: tuple[str, ...] = (),
    ) -> None:
        self.seconds, self.growth, self.danger, self.mode = seconds, growth, danger, mode
        self.worker, self.grown = None, ""

    def __enter__(self) -> "Supervisor":
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def run(self, words: list[str], watched: tuple[Path, ...] = ()) -> Ended:
        """Run the command; its files in `watched` must be whole, or untouched if it refuses.

        A run over the limit is tried once more: only what hangs twice hangs.
        """
        ended = self._once(words, watched)
        if ended.problems == ["hangs"]:
            ended = self._once(words, watched)
        return ended

    def _once(self, words: list[str], watched: tuple[Path, ...]) -> Ended:
        before = [_files(folder) for folder in watched]
        self._start()
        self._send(words)
        answer = self._receive(self.seconds, memory(self.worker.pid, "VmRSS") + self.danger)
        if answer is None:
            code, grown = self.worker.poll(), self.grown
            self.stop()
            problem = "hangs" if code is None else f"crashes with {code}"
            return Ended(None, problems=[grown or problem], seconds=self.seconds)
        if answer["held"] > TIRED:
            self.stop()
        ended = Ended(answer["code"], seconds=answer["seconds"], grew=answer["grew"])
        said = [line for line in answer["err"].splitlines() if not PROGRESS.match(line)]
        if ended.code == 2:
            ended.line = "\n".join(said)
            ended.problems += unclear(ended.line)
            for folder, was in zip(watched, before, strict=True):
                ended.problems += _left_behind(was, _files(folder))
        elif said or ended.code not in (0, 1):
            ended.problems.append(f"ends with {ended.code} and says {' / '.join(said)[-600:]}")
        if ended.code != 2:
            for folder in watched:
                hidden = [name for name in _files(folder) if Path(name).name.startswith(".")]
                ended.problems += [f"leaves {name}" for name in hidden]
        if ended.grew > self.growth:
            ended.problems.append(f"takes {ended.grew / 2**20:.0f} MiB")
        return ended

    def _start(self) -> None:
        if self.worker is not None and self.worker.poll() is None:
            return
        self.worker = subprocess.Popen(
            [sys.executable, "-m", "tests.fuzz.worker", *self.mode],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            cwd=Path(__file__).resolve().parents[2],
            env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        )
        if self._receive(PATIENCE) != "ready":
            raise RuntimeError("the worker does not start: python -m tests.fuzz.worker says why")

    def stop(self) -> None:
        """End the worker."""
        if self.worker is not None:
            self.worker.kill()
            self.worker.communicate()
        self.worker = None

    def _send(self, words: list[str]) -> None:
        self.worker.stdin.write(json.dumps(words) + "\n")
        self.worker.stdin.flush()

    def _receive(self, seconds: float, most: float = math.inf):
        """The next answer; None where there is none in time, or no worker any more.

        Args:
            most: bytes that the worker may hold meanwhile.
        """
        end, self.grown = time.monotonic() + seconds, ""
        while time.monotonic() < end:
            if select.select([self.worker.stdout], [], [], 0.05)[0]:
                if line := self.worker.stdout.readline():
                    return json.loads(line)
                self.worker.wait()
                return None
            if memory(self.worker.pid, "VmRSS") > most:
                self.grown = f"takes more than {self.danger / 2**20:.0f} MiB"
                return None
        return None


def unclear(line: str) -> list[str]:
    """What is wrong with a refusal, as a user reads it."""
    if "Traceback" in line or "this is a bug" in line:
        last = [said.strip() for said in line.splitlines() if said.strip()][-4:]
        return [f"shows a traceback: {' / '.join(last)}"]
    found = []
    if len(line.splitlines()) != 1:
        found.append(f"refuses in {len(line.splitlines())} lines")
    if not re.fullmatch(r"(error: )?\S.*: .+; \S.*", line):
        found.append("does not say 'where: what; what would be right'")
    if len(line) > LONGEST:
        found.append(f"refuses in {len(line)} characters")
    if not line.replace("\n", "").isprintable():
        found.append("prints what is not printable")
    if match := INTERNAL.search(line):
        found.append(f"speaks of {match[0]!r}")
    return [f"{problem}: {line[:300]}" for problem in found]


def _files(folder: Path) -> dict[str, tuple[int, bytes]]:
    """When each file of a folder was written, and what it holds."""
    return {
        str(path.relative_to(folder)): (path.stat().st_mtime_ns, path.read_bytes())
        for path in folder.rglob("*")
        if path.is_file()
    }


def _left_behind(before: dict, after: dict) -> list[str]:
    """What a refused run wrote or took; an earlier run's results may be gone, or as they were."""
    new = [f"refuses, but leaves {name}" for name in after if after[name] != before.get(name)]
    lost = [name for name in before if name not in after and Path(name).name not in RESULTS]
    return new + [f"refuses, but takes away {name}" for name in lost]
