"""Candidates from outside: a folder of EXRs, or any program that draws a case."""

import os
import shlex
import shutil
import signal
import subprocess
import tempfile
import time
from contextlib import suppress
from pathlib import Path
from typing import Protocol

from scenes.environment import read_pixels
from scenes.errors import InputError
from scenes.frame import Frame
from scenes.schema import Case

OUTSIDE = "candidate"  # the technique of an outside candidate's rows; nobody knows its switches


class Candidate(Protocol):
    """Anything that answers a case with a frame: the one protocol of all renderers."""

    def render(self, case: Case) -> Frame:
        """Draw the case as linear radiance, (H, W, 3) float32."""


class CandidateError(Exception):
    """A candidate that gave no picture; it fails its own rows and nothing else."""


class Folder:
    """Pictures made elsewhere: `<case id>.exr` in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def render(self, case: Case) -> Frame:
        """Read the picture of the case.

        Raises:
            CandidateError: it is missing or cannot be decoded.
        """
        path = self.folder / f"{case.id}.exr"
        try:
            return Frame(read_pixels(path, "picture", (case.width, case.height)))
        except InputError as error:
            raise CandidateError(f"{path.name}: {error.problem}") from error


class Command:
    """A program, run once per case as a template with {case} and {out}.

    {case} becomes the path of the case as JSON (scenes/FORMAT.md), {out} that of the EXR to
    write: linear RGB, row 0 on top, width x height of the case.
    """

    def __init__(self, template: str, timeout: float) -> None:
        self.words, self.timeout = shlex.split(template), timeout

    def render(self, case: Case) -> Frame:
        """Run the program and read what it wrote; `seconds` is its whole wall time.

        Raises:
            CandidateError: it timed out, failed, or wrote no picture.
        """
        with tempfile.TemporaryDirectory() as folder:
            description, out = Path(folder) / "case.json", Path(folder) / "out.exr"
            description.write_text(case.model_dump_json(indent=1), encoding="utf-8")
            seconds = self.run(description, out)
            if not out.exists():
                raise CandidateError("ended with exit code 0 but wrote no picture")
            try:
                rgb = read_pixels(out, "picture", (case.width, case.height))
            except InputError as error:
                raise CandidateError(f"picture {error.problem}") from error
        return Frame(rgb, None, seconds, {"renderer": self.words[0]})

    def run(self, case: Path, out: Path) -> float:
        """Run the program on two paths; the seconds that it took.

        Raises:
            CandidateError: it timed out or failed.
        """
        words = [w.replace("{case}", str(case)).replace("{out}", str(out)) for w in self.words]
        start = time.perf_counter()
        code, said = _run(words, self.timeout)
        if code != 0:
            raise CandidateError(f"exit code {code}" + (f": {said[-1]}" if said else ""))
        return time.perf_counter() - start


def _run(words: list[str], timeout: float) -> tuple[int, list[str]]:
    """Run a program; its exit code and the lines of its standard error.

    It gets a process group of its own, which ends with it: nothing that it started may go on
    beside later timings.
    """
    with subprocess.Popen(
        words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True
    ) as process:
        try:
            _, said = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired as error:
            raise CandidateError(f"took longer than {timeout:g} s") from error
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
    return process.returncode, said.decode(errors="replace").strip().splitlines()


def outside_candidate(text: str, timeout: float) -> Candidate:
    """A candidate from the command line: a folder, or a command with {case} and {out}.

    Raises:
        InputError: it is neither.
    """
    if "{case}" in text or "{out}" in text:
        if not ("{case}" in text and "{out}" in text):
            raise InputError("--candidate", "", "names only one of {case} and {out}", "name both")
        try:
            command = Command(text, timeout)
        except ValueError as error:
            raise InputError("--candidate", "", f"{error}".lower(), "mend the quotes") from error
        if shutil.which(command.words[0]) is None:
            raise InputError("--candidate", command.words[0], "no such program", "check its path")
        return command
    if not Path(text).is_dir():
        remedy = "give a folder of EXRs, or a command with {case} and {out}"
        problem = "is a file, no folder" if Path(text).is_file() else "no such folder"
        raise InputError("--candidate", text, problem, remedy)
    if not any(Path(text).glob("*.exr")):
        remedy = "put <case>.exr there; `shadeproof compare --list` prints the names"
        raise InputError("--candidate", text, "holds no .exr", remedy)
    return Folder(Path(text))
