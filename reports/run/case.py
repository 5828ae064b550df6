"""One case: its candidates, reference by reference, then the causes of error."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from reference.batches import grow, truth_of
from reference.store import Store
from renderer.techniques import Technique, switched
from reports import gate, parity
from reports.candidates import CandidateError
from reports.compare import Truth, exposures_of
from reports.ladder import Drawn, ladder, rungs_of
from reports.progress import Reporter
from reports.results import CaseRecord, Ladder, Row
from reports.rows import Picture, judged_rows, measured_further
from reports.run.job import Job, Source
from reports.run.makers import Makers
from reports.run.own_truths import own_batches
from reports.run.shots import Shot, ours
from scenes.camera import seen_objects
from scenes.errors import InputError
from scenes.frame import Frame, save_frame
from scenes.schema import Case
from scenes.suite import Entry


def run_entry(
    job: Job, entry: Entry, report: Reporter, checks: parity.Checks, makers: Makers
) -> tuple[CaseRecord, list[Row], list[Ladder]]:
    """One case: all its candidates, then reference by reference, then the causes of error."""
    case = entry.case
    _check_visible(case, job.path)
    shots = job.shots(entry, entry.truths)
    frames, failures = _draw(job, entry, report)
    rows: list[Row] = []
    exposures: dict[str, float] = {}
    truths: dict[str, list[Frame]] = {}
    views: dict[str, Truth] = {}
    for source in job.sources(entry):
        report.step(f"{case.id}: compare with {', '.join(source.truths)}")
        judged: list[Row] = []

        def enough(batches: list[Frame], source: Source = source) -> bool:
            nonlocal exposures, judged
            exposures = exposures or exposures_of(case, batches)
            judged = []
            for name, own in source.truths.items() if source.judged else ():
                views[name] = Truth(case, name, _of(job, batches, own), exposures)
                rules = job.suite.budget
                against = _against(name, shots, frames)
                judged += judged_rows(case, views[name], against, failures, rules, job.family)
            return all(gate.settled(r) for r in judged)

        def traced(done: int, wanted: int, source: Source = source) -> None:
            named = " and ".join(source.truths)
            report.detail(f"{case.id}: trace {named}, batch {done} of {wanted}")

        batches = _batches(job, source, enough, traced)
        if source.judged and (not judged or judged[0].reference_batches != len(batches)):
            enough(batches)  # at the cap `grow` does not ask
        if not job.truth:
            makers.add(batches)
        rows += judged
        for name, own in source.truths.items():
            truths[name] = _of(job, batches, own)
    if job.verdict_only:
        told = set()
    elif job.brief:  # of what meets its budget no more is said
        told = {(r.technique, r.object) for r in rows if r.verdict in ("fail", "inconclusive")}
    else:
        told = {(r.technique, r.object) for r in rows}
    report.detail(f"{case.id}: measure further, and tell causes")
    further = measured_further(case, views, frames, [r for r in rows if _about(r) in told])
    rows = [r for r in rows if _about(r) not in told] + further
    ladders = _ladders(job, entry, frames, truths, further)
    for name in entry.truths:
        mean = _mean(truths[name])
        for label, picture in _against(name, shots, frames).items():
            own = [r for r in rows if (r.technique, r.truth) == (label, name)]
            checks.add_frame(case, label, picture.frame, mean, own)
    candidates = {}
    for label, frame in frames.items():
        candidates[label] = f"frames/{case.id}/{label}.exr"
        save_frame(frame, job.out / candidates[label])
    record = CaseRecord(
        id=case.id,
        scene=case.scene,
        environment=case.environment.name,
        width=case.width,
        height=case.height,
        objects=[o.name for o in case.objects],
        candidates=candidates,
        truths={t: _save_halves(job.out, case, t, truths[t]) for t in entry.truths},
    )
    return record, rows, ladders


def _batches(
    job: Job,
    source: Source,
    enough: Callable[[list[Frame]], bool],
    traced: Callable[[int, int], None],
) -> list[Frame]:
    """The batches of a reference: path-traced until there are enough, or one's own."""
    if job.truth:
        (name,) = source.truths
        return own_batches(job.truth, source.case, name)
    store, sampling = Store(job.store), job.suite.reference
    return grow(source.case, source.kind, sampling, enough, store, traced, job.executor, job.frozen)


def _of(job: Job, batches: list[Frame], truth: str) -> list[Frame]:
    """One truth of some batches; one's own are of one already, and tell no diffuse light apart."""
    return batches if job.truth else [truth_of(b, truth) for b in batches]


def _mean(batches: list[Frame]) -> Frame:
    """All batches as one frame, with the ids of the first."""
    mean = np.mean([b.rgb for b in batches], axis=0, dtype=np.float64)
    return Frame(mean.astype(np.float32), batches[0].ids)


def _about(row: Row) -> tuple[str, str]:
    return row.technique, row.object


def _against(
    truth: str, shots: dict[str, dict[str, Shot]], frames: dict[str, Frame]
) -> dict[str, Picture]:
    """The pictures that stand against a truth, by technique, of those that there are."""
    own = {label: by_truth[truth] for label, by_truth in shots.items()}
    return {
        label: Picture(shot.name, frames[shot.name], shot.case.model)
        for label, shot in own.items()
        if shot.name in frames
    }


def _ladders(
    job: Job,
    entry: Entry,
    frames: dict[str, Frame],
    truths: dict[str, list[Frame]],
    rows: list[Row],
) -> list[Ladder]:
    """Error by cause for every object and technique that has rows, where there are the truths.

    One's own references do not tell diffuse light apart, so nothing is drawn for its parts.
    """
    if not rungs_of(truths):
        return []  # before anything is drawn for it
    made, compared = [], {r.technique for r in rows if r.picture in frames}
    for label, shots in job.shots(entry, truths).items():
        if label not in compared:
            continue
        named = {shot.name: shot for shot in shots.values()}
        pictures = {name: _drawn(job, shot, frames) for name, shot in named.items()}
        drawn = {truth: pictures[shot.name] for truth, shot in shots.items()}
        for obj in entry.case.judged:
            own = [r for r in rows if _about(r) == (label, obj.name)]
            if own and (found := ladder(entry.case, obj, label, drawn, truths, own)):
                made.append(found)
    return made


def _drawn(job: Job, shot: Shot, frames: dict[str, Frame]) -> Drawn:
    """A picture and the same with single switches thrown, as far as it can be had."""
    if job.truth or shot.candidate is job.outside:
        return Drawn(frames[shot.name].rgb)

    def picture(how: Technique) -> np.ndarray:
        return ours(how, timed=False).render(shot.case).rgb

    how = shot.candidate.technique
    whole = frames[shot.name].rgb if shot.name in frames else picture(how)
    thrown = {name: picture(other) for name, other in switched(how, shot.case.model).items()}
    return Drawn(whole, thrown.pop("specular"), thrown)


def _check_visible(case: Case, path: Path) -> None:
    """Refuse a judged object that nobody can see, before anything is traced for it."""
    ids = seen_objects(case)
    for obj in case.judged:
        if not (ids == case.index(obj.name)).any():
            problem = f"covers no pixel of {case.id}"
            remedy = "move it or the camera, or set judged = false"
            raise InputError(path, f"object '{obj.name}'", problem, remedy)


def _draw(job: Job, entry: Entry, report: Reporter) -> tuple[dict[str, Frame], dict[str, str]]:
    """Every picture by name, and why some gave none."""
    frames, failures = {}, {}
    for name, shot in job.pictures(entry).items():
        report.step(f"{entry.case.id}: {name}")
        try:
            frames[name] = shot.candidate.render(shot.case)
        except CandidateError as error:
            failures[name] = str(error)
    return frames, failures


def _save_halves(out: Path, case: Case, truth: str, batches: list[Frame]) -> tuple[str, str]:
    """Write the means of the even and of the odd batches; their paths relative to `out`."""
    names = []
    for half, label in enumerate("ab"):
        kept = batches[half::2] or batches
        mean = np.mean([b.rgb for b in kept], axis=0, dtype=np.float64).astype(np.float32)
        seconds = sum(b.seconds for b in kept)
        names.append(f"truths/{case.id}/{truth}.{label}.exr")
        save_frame(Frame(mean, kept[0].ids, seconds, kept[0].provenance), out / names[-1])
    return names[0], names[1]
