"""The doctor's examination: the candidate draws its cases, our own renderer makes the mistakes."""

import tempfile
from pathlib import Path

import numpy as np

from renderer.draw import Renderer
from renderer.techniques import technique
from reports.candidates import Candidate, CandidateError
from reports.display import FAINTEST
from reports.doctor.diagnosis import Diagnosis, diagnose
from reports.doctor.scenes import doctor_cases
from reports.progress import reporting
from reports.run.job import make_folder
from scenes.frame import Frame, write_text
from scenes.schema import Case

TECHNIQUE = "filtered"  # nothing stands in another's way in these cases


def examine(candidate: Candidate) -> Diagnosis:
    """Say what is wrong with a candidate."""
    renderer = Renderer(technique(TECHNIQUE), repeats=0)

    def draw(case: Case) -> Frame:
        return renderer.render(case)

    with tempfile.TemporaryDirectory(prefix="shadeproof-") as name:
        folder = Path(name)
        cases, pictures, lost = doctor_cases(folder), {}, {}
        with reporting(len(cases) + 1) as report:
            for key, case in cases.items():
                report.step(f"{case.id}: the candidate draws it")
                try:
                    drawn = candidate.render(case).rgb
                except CandidateError as error:
                    lost[key] = str(error)
                    continue
                if problem := _unfit(drawn):
                    lost[key] = problem
                else:
                    pictures[key] = drawn
            report.step("tell what is wrong")
            return diagnose(cases, pictures, lost, draw, folder)


def _unfit(rgb: np.ndarray) -> str:
    """What makes a picture no picture of light; empty where nothing does."""
    bad = int((~np.isfinite(rgb).all(axis=2)).sum())
    if bad:
        return f"NaN or Inf in {bad} of {rgb.shape[0] * rgb.shape[1]} pixels"
    below = int((rgb < -FAINTEST).any(axis=2).sum())
    if below:
        return f"light below zero in {below} of {rgb.shape[0] * rgb.shape[1]} pixels"
    return "it is black" if not rgb.any() else ""


def write_cases(folder: Path) -> list[Path]:
    """Write the doctor's cases as JSON, with their files, for a renderer that draws them elsewhere.

    Raises:
        InputError: the folder cannot be written.
    """
    make_folder(folder, "--cases")
    made = []
    for case in doctor_cases(folder).values():
        made.append(folder / f"{case.id}.json")
        write_text(made[-1], case.model_dump_json(indent=1) + "\n")
    return made
