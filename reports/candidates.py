"""Candidates from outside: a folder of EXRs, or any program that draws a case."""

import shlex
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Protocol

from scenes.errors import InputError
from scenes.frame import Frame, load_frame
from scenes.schema import Case


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
            return load_frame(path)
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
            description.write_text(case.model_dump_json(indent=1))
            words = [
                w.replace("{case}", str(description)).replace("{out}", str(out)) for w in self.words
            ]
            start = time.perf_counter()
            try:
                done = subprocess.run(words, capture_output=True, timeout=self.timeout, check=False)
            except subprocess.TimeoutExpired as error:
                raise CandidateError(f"took longer than {self.timeout:g} s") from error
            except OSError as error:
                raise CandidateError(f"cannot be started ({error.strerror})") from error
            seconds = time.perf_counter() - start
            if done.returncode != 0:
                said = done.stderr.decode(errors="replace").strip().splitlines()
                raise CandidateError(
                    f"exit code {done.returncode}" + (f": {said[-1]}" if said else "")
                )
            try:
                frame = load_frame(out)
            except InputError as error:
                raise CandidateError(f"picture {error.problem}") from error
        return Frame(frame.rgb, frame.ids, seconds, {"renderer": self.words[0]})


def outside_candidate(text: str, timeout: float) -> Candidate:
    """A candidate from the command line: a folder, or a command with {case} and {out}.

    Raises:
        InputError: it is neither.
    """
    if "{case}" in text or "{out}" in text:
        if not ("{case}" in text and "{out}" in text):
            raise InputError("--candidate", "", "names only one of {case} and {out}", "name both")
        return Command(text, timeout)
    if not Path(text).is_dir():
        remedy = "give a folder of EXRs, or a command with {case} and {out}"
        raise InputError("--candidate", text, "no such folder", remedy)
    return Folder(Path(text))
