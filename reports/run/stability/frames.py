"""Whole pictures of hard cases by every technique, through the renderer that users run."""

from collections.abc import Collection, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.ndimage import maximum_filter, minimum_filter

from renderer.draw import Renderer
from renderer.techniques import technique
from reports.progress import reporting
from reports.stability.hard import hard_cases
from reports.stability.hard.case import TECHNIQUES, Draw, Hard, off
from reports.stability.results import HardCase
from scenes.errors import InputError
from scenes.frame import Frame
from scenes.schema import Case
from scenes.words import nearest

LARGEST_HALF = float(np.finfo(np.float16).max)  # 65,504
ENERGY_SAMPLES, ENERGY_BATCHES = 256, 4  # of Mitsuba, per pixel


def hard_frames(names: Collection[str] = ()) -> list[HardCase]:
    """Draw the hard cases, or the named ones.

    Raises:
        InputError: there is no case of such a name.
    """
    rows = hard_cases()
    for name in names:
        if name not in rows:
            remedy = nearest(name, rows) + "see `shadeproof stability --list`"
            raise InputError("--hard", "", f"there is no hard case '{name}'", remedy)
    chosen = [rows[name] for name in names] or list(rows.values())
    found = []
    with reporting(len(chosen)) as report, TemporaryDirectory(prefix="shadeproof-") as folder:
        for row in chosen:
            report.step(f"{row.kind} {row.name}")
            found.append(measure(row, Path(folder)))
    return found


def measure(row: Hard, folder: Path, techniques: Sequence[str] = TECHNIQUES) -> HardCase:
    """Draw one hard case with every technique and judge it; its files go into the folder."""
    judged = _refusal(row, folder) if row.refused else _pictures(row, folder, techniques)
    return HardCase(
        name=row.name,
        kind=row.kind,
        must_hold=row.must_hold,
        why=row.why,
        measured={what: figure for what, (figure, _) in judged.items()},
        passed=all(passed for _, passed in judged.values()),
        command=f"shadeproof stability --hard {row.name}",
    )


Judged = dict[str, tuple[float, bool]]  # a figure and whether it passes, by words


def _refusal(row: Hard, folder: Path) -> Judged:
    try:
        _draw(TECHNIQUES[0], row.case(folder))
    except InputError as error:
        return {"refused in one line": (1.0, row.refused in str(error))}
    return {"refused in one line": (0.0, False)}


def _pictures(row: Hard, folder: Path, techniques: Sequence[str]) -> Judged:
    case = row.case(folder)
    frames = {
        name: _draw(name, case) for name in dict.fromkeys((*techniques, *row.within, *row.energy))
    }
    unfit = sum(int((~(f.rgb >= 0) | np.isinf(f.rgb)).any(axis=2).sum()) for f in frames.values())
    found: Judged = {"pixels NaN, Inf or negative": (unfit, unfit == 0)}
    if row.brightest:
        least = min(float(f.rgb.max()) for f in frames.values())
        clipped = min(int((f.rgb > LARGEST_HALF).any(axis=2).sum()) for f in frames.values())
        found["brightest pixel, least of all techniques"] = (least, least >= row.brightest)
        found["pixels that half floats would clip"] = (clipped, True)
    if row.between:
        found |= _between(row, frames)
    if row.expect:
        for name, limit in row.within.items():
            found |= _compared(row, folder, frames[name], partial(_draw, name), name, limit)
    if row.silhouette is not None:
        found |= _outline(row, case, frames[techniques[0]])
    for name, limit in row.energy.items():
        found |= _energy(case, frames[name], name, limit)
    return found


def _draw(name: str, case: Case, part: tuple[int, int, int, int] | None = None) -> Frame:
    return Renderer(technique(name), repeats=0).render(case, part)


def _between(row: Hard, frames: dict[str, Frame]) -> Judged:
    """Radiance at the objects' pixels; one direction a pixel is noise, and left out."""
    seen = [f.rgb[f.ids > 0] for name, f in frames.items() if name != "sampled@1"]
    if blank := sum(not s.size for s in seen):
        return {"techniques that show no object": (blank, False)}
    low, high = (float(end) for end in (min(s.min() for s in seen), max(s.max() for s in seen)))
    return {
        "least on objects": (low, low >= row.between[0]),
        "most on objects": (high, high <= row.between[1]),
    }


def _compared(row: Hard, folder: Path, frame: Frame, draw: Draw, name: str, limit: float) -> Judged:
    where = np.ones(frame.ids.shape, bool)
    if row.interior:
        where = (maximum_filter(frame.ids, 5) == minimum_filter(frame.ids, 5)) & (frame.ids > 0)
        if not where.any():
            return {f"pixels inside objects, {name}": (0, False)}
    rms, most = off(frame.rgb, row.expect(draw, folder), where)
    return {f"off, {name}": (rms, rms <= limit), f"off at worst, {name}": (most, True)}


def _outline(row: Hard, case: Case, frame: Frame) -> Judged:
    """The share of pixels that show another object than a ray of Mitsuba through the centre."""
    from reference.truths import covered

    other = float((frame.ids != covered(case)[1]).mean())
    return {"pixels of another object than Mitsuba's": (other, other <= row.silhouette)}


def _energy(case: Case, frame: Frame, name: str, limit: float) -> Judged:
    """The light on the objects against Mitsuba's without occlusion."""
    from reference.batches import render_batch, truth_of

    batches = [render_batch(case, "model", ENERGY_SAMPLES, 1 + k) for k in range(ENERGY_BATCHES)]
    on = frame.ids > 0
    if not on.any():
        return {f"pixels of objects, {name}": (0, False)}
    truths = [truth_of(b, "unoccluded").rgb[on].mean(dtype=float) for b in batches]
    truth, spread = np.mean(truths), np.std(truths, ddof=1) / np.sqrt(len(truths))
    ratio = float(frame.rgb[on].mean(dtype=float) / truth - 1)
    return {
        f"energy, {name}": (ratio, abs(ratio) <= limit),
        "standard error of Mitsuba's": (float(spread / truth), True),
    }
