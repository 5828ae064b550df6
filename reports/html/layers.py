"""What the viewer of a case shows: pictures as linear radiance and maps, each as numbers."""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from reports.frames import CaseFrames, PictureError, told
from reports.html.colour import ERROR, SIGNED, SIMILARITY, Scale
from reports.html.figures import slug
from reports.html.packing import packed_places, packed_radiance
from reports.metrics.energy import block_errors
from reports.metrics.flip import flip_maps
from reports.metrics.ssim import ssim_map
from reports.metrics.subject import Subject
from reports.results import Row

Maps = Callable[[Sequence[Subject]], Sequence[np.ndarray]]  # (h, w) each


@dataclass(frozen=True)
class Layer:
    """One picture or map of a case, or why there is none.

    Attributes:
        id: of the element that holds its data.
        kind: `candidate`, `truth`, `objects` or a key of MAPS.
        techniques, truths: those with which it is shown; empty for all of them.
        name: of a candidate's picture, as in its rows.
        scale: what the radiance in the data has to be multiplied by.
        data: what `packing` makes; empty where there is a problem.
    """

    id: str
    kind: str
    techniques: tuple[str, ...] = ()
    truths: tuple[str, ...] = ()
    name: str = ""
    scale: float = 1.0
    problem: str = ""
    data: str = ""

    @property
    def told(self) -> dict[str, Any]:
        """All but the data, for the page's script."""
        return {name: value for name, value in asdict(self).items() if name != "data"}


def _similarity(subject: Subject) -> np.ndarray:
    """SSIM per pixel (h, w), mean over channels."""
    return ssim_map(subject, subject.truth.exposure).mean(axis=2)


def _each(compute: Callable[[Subject], np.ndarray]) -> Maps:
    return lambda subjects: [compute(subject) for subject in subjects]


MAPS: dict[str, tuple[Maps, Scale]] = {
    "blocks": (_each(block_errors), SIGNED),
    "ssim": (_each(_similarity), SIMILARITY),
    "flip": (flip_maps, ERROR),
}


def case_layers(frames: CaseFrames) -> list[Layer]:
    """Everything that the viewer of a case shows."""
    rows, name = frames.rows, frames.record.id
    truths = list(dict.fromkeys([*frames.record.truths, *(r.truth for r in rows)]))
    pictures = [
        (
            Layer(slug("layer", name, "candidate", shown), "candidate", own, against, shown),
            partial(_radiance, frames.candidate, shown),
        )
        for shown, own, against in candidates(frames)
    ]
    for t in truths:
        layer = Layer(slug("layer", name, "truth", t), "truth", (), (t,))
        pictures.append((layer, partial(_radiance, frames.truth, t)))
    pictures.append((Layer(slug("layer", name, "objects"), "objects"), partial(_objects, frames)))
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        made = list(pool.map(lambda one: _made(*one), pictures))
        made += [layer for kind in MAPS for layer in _maps(frames, kind, pool)]
    return made


def candidates(frames: CaseFrames) -> list[tuple[str, tuple[str, ...], tuple[str, ...]]]:
    """Every candidate's picture: its name, its technique, and the truths that it is shown beside.

    These are those that it was compared with where its technique has other pictures too; else all.
    """
    rows, found = frames.rows, []
    for name in dict.fromkeys([*frames.record.candidates, *(r.picture for r in rows)]):
        technique = next((r.technique for r in rows if r.picture == name), name)
        all_own = {r.picture for r in rows if r.technique == technique}
        against = dict.fromkeys(r.truth for r in rows if r.picture == name)
        found.append((name, (technique,), tuple(against) if len(all_own) > 1 else ()))
    return found


def _radiance(read: Callable[[str], np.ndarray], name: str) -> dict[str, Any]:
    data, scale = packed_radiance(read(name))
    return {"data": data, "scale": scale}


def _objects(frames: CaseFrames) -> dict[str, Any]:
    """At each pixel the number of the judged object there, from 1; 0 where there is none."""
    names = list(dict.fromkeys(r.object for r in frames.rows))
    shown = np.zeros((frames.record.height, frames.record.width), np.uint8)
    for row in frames.rows:
        try:
            shown[frames.mask(row.truth, row.object)] = 1 + names.index(row.object)
        except PictureError:
            continue
    return {"data": packed_places(shown)}


def _maps(frames: CaseFrames, kind: str, pool: ThreadPoolExecutor) -> list[Layer]:
    """One map of a kind for each technique and truth, over the objects of its rows."""
    pairs = dict.fromkeys((r.technique, r.truth) for r in frames.rows)
    jobs = [
        (
            Layer(slug("layer", frames.record.id, kind, *pair), kind, pair[:1], pair[1:]),
            partial(_map, frames, kind, [r for r in frames.rows if (r.technique, r.truth) == pair]),
        )
        for pair in pairs
    ]
    return list(pool.map(lambda one: _made(*one), jobs))


def _map(frames: CaseFrames, kind: str, rows: list[Row]) -> dict[str, Any]:
    """One map over the objects of rows; one that cannot be shown is left out if others can."""
    compute, scale = MAPS[kind]
    seen, problems = [], []
    for row in rows:
        try:
            seen.append(frames.subject(row))
        except Exception as error:  # the other objects still have something to show
            problems.append(told(error))
    if not seen:
        raise PictureError(problems[0])
    shown = np.zeros((frames.record.height, frames.record.width), np.uint8)
    with np.errstate(all="ignore"):
        maps = compute([subject for subject, _ in seen])
    for (subject, crop), values in zip(seen, maps, strict=True):
        mask = subject.truth.mask
        shown[crop][mask] = scale.places(values, mask)[mask]
    return {"data": packed_places(shown)}


def _made(layer: Layer, make: Callable[[], dict[str, Any]]) -> Layer:
    """The layer with its data, or its absence with the reason."""
    try:
        with np.errstate(all="ignore"):  # NaN and Inf of a candidate are counted in its row
            return replace(layer, **make())
    except Exception as error:  # one bad picture must not cost the whole page
        return replace(layer, problem=told(error))
