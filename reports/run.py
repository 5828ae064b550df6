"""The whole job, from a suite to results: the only file that knows both renderers."""

import datetime
import fnmatch
import math
import platform
import shutil
import tempfile
import time
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import cached_property
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from reference import probe as reference_probe
from reference.batches import Task, grow, lacking, prefetch, render_batch, truth_of
from reference.executor import connect
from reference.settings import FEWEST_BATCHES, TRUTHS, Kind, rounded_samples
from reference.store import Store
from reference.timing import seconds_per_sample
from renderer import probe
from renderer.context import device
from renderer.draw import Renderer, object_ids
from renderer.features import switched, technique
from reports import gate, parity
from reports.calibration import Pool
from reports.candidates import Candidate, CandidateError
from reports.compare import Truth, exposures_of
from reports.efficiency import Efficiency, efficiencies
from reports.ladder import MODEL_STEPS, Drawn, ladder
from reports.progress import Reporter, reporting
from reports.results import CaseRecord, Ladder, Missing, Results, Row
from reports.rows import judged_rows, measured_further
from reports.speed import Timing
from reports.stability import MASKINGS, Agreement, agreement, directions, materials, oracle
from scenes.environment import load_environment
from scenes.errors import InputError
from scenes.frame import Frame, save_frame
from scenes.mesh import placement
from scenes.schema import PHYSICAL, Case, Material, Model
from scenes.suite import Entry, Suite, expand, load_suite

OUTSIDE = "candidate"  # the technique under which an outside candidate's rows stand
PACKAGES = ("mitsuba", "drjit", "moderngl", "numpy", "scipy", "scikit-image", "flip-evaluator")


@dataclass(frozen=True)
class Job:
    """What to run: a suite, which of its cases, with which candidates, and where to.

    Attributes:
        frozen: use the references that are stored, and trace nothing.
        cluster: the Dask scheduler whose workers trace their batches; this process if empty.
        brief: of what meets its budget, measure no more than the verdict needs.
    """

    suite_name: str
    out: Path
    store: Path
    filter: str = ""
    outside: Candidate | None = None
    command: str = ""
    frozen: bool = False
    cluster: str = ""
    brief: bool = False
    suite: Suite = field(init=False)
    path: Path = field(init=False)
    entries: list[Entry] = field(init=False)
    skipped: list[str] = field(init=False)
    whole: list[Entry] = field(init=False)

    def __post_init__(self) -> None:
        suite, path = load_suite(self.suite_name)
        whole = expand(suite, path)
        entries = [e for e in whole if _matches(e.case.id, self.filter)]
        skipped = [e.case.id for e in whole if e not in entries]
        if not entries:
            raise InputError(
                "--filter", self.filter, "no case matches", "see `--list` for their names"
            )
        for name in {t for e in entries for t in e.techniques}:
            try:
                technique(name)
            except ValueError as error:
                raise InputError(path, "techniques", str(error), "use a known technique") from error
            if not self.outside and (what := technique(name).cannot_draw(suite.model)):
                problem = f"'{name}' cannot draw {what}"
                raise InputError(path, "model", problem, "leave it out, or give a --candidate")
        for entry in entries:
            load_environment(entry.case.environment.path)
            for obj in entry.case.objects:
                placement(obj)
                _check_physical(entry, obj.material, path)
        gate.check_rules(suite.budget, whole, OUTSIDE, path)
        object.__setattr__(self, "suite", suite)
        object.__setattr__(self, "path", path)
        object.__setattr__(self, "entries", entries)
        object.__setattr__(self, "whole", whole)
        object.__setattr__(self, "skipped", [f"{i} (filter '{self.filter}')" for i in skipped])

    @cached_property
    def executor(self) -> Executor | None:
        """What traces the batches, if not this process."""
        return connect(self.cluster) if self.cluster and not self.frozen else None

    @property
    def family(self) -> int:
        """How many verdicts must hold together: the whole suite's, at every look at its batches."""
        label = OUTSIDE if self.outside else ""
        return gate.family_size(self.suite.budget, self.whole, self.suite.reference, label)

    def candidates(self, entry: Entry) -> dict[str, Candidate]:
        """What draws an entry's case, by technique."""
        if self.outside:
            return {OUTSIDE: self.outside}
        return {name: Renderer(technique(name)) for name in entry.techniques}

    def expected(self, entries: list[Entry]) -> list[Missing]:
        """Every row that the suite asks for in some of its entries."""
        return [
            Missing(case=e.case.id, object=o.name, technique=t, truth=truth)
            for e in entries
            for t in ([OUTSIDE] if self.outside else e.techniques)
            for truth in e.truths
            for o in e.case.judged
        ]


def run(job: Job) -> Results:
    """Draw, path-trace and compare every case of a job, and judge it.

    Frames are written to `job.out`; the results are returned, not written.
    """
    start = time.perf_counter()
    _make_folder(job.out, "--out")
    _clear(job.out)
    if job.executor and not job.frozen:
        trace_ahead(job, FEWEST_BATCHES)
    elif not job.frozen:
        _make_folder(job.store, "--store")
    rows: list[Row] = []
    cases: list[CaseRecord] = []
    ladders: list[Ladder] = []
    checks = parity.Checks()
    steps = sum(len(job.candidates(e)) + len(sources(e)) for e in job.entries)
    with reporting(steps) as report:
        for entry in job.entries:
            record, made, causes = _run_entry(job, entry, report, checks)
            cases.append(record)
            rows += made
            ladders += causes
    if not job.outside:
        surfaces = {(o.material, e.case.model) for e in job.entries for o in e.case.judged}
        checks.shaders += [_beside_oracle(*s) for s in surfaces]
    results = Results(
        suite=job.path.stem,
        suite_path=str(job.path),
        description=job.suite.description,
        command=job.command,
        created=datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        seconds=time.perf_counter() - start,
        provenance=_provenance() | {"parity": checks.verdicts()},
        allow_inconclusive=job.suite.allow_inconclusive,
        expected_rows=len(job.expected(job.whole)),
        missing=gate.missing_rows(job.expected(job.entries), rows),
        skipped=job.skipped,
        cases=cases,
        budgets=list(job.suite.budget),
        rows=rows,
        ladders=ladders,
        verdict="fail",
        reasons=[],
    )
    return gate.conclude(results)


@dataclass(frozen=True)
class Source:
    """A reference that an entry needs: what is traced, and which of its truths are wanted.

    Attributes:
        truths: by the name under which it is reported, the truth that the reference holds.
        judged: whether candidates are held against it; else it only splits the model's error.
    """

    case: Case
    kind: Kind
    truths: dict[str, str]
    judged: bool = True


def sources(entry: Entry) -> list[Source]:
    """Every reference of an entry; the one with `global`, which sets the exposure, first."""
    case, wanted = entry.case, entry.truths
    found = []
    if shared := {t: t for t in TRUTHS["model"] if t in wanted}:
        found.append(Source(case, "model", shared))
    if "physical" in wanted:
        found.append(Source(case, "physical", {"physical": "physical"}))
    if "physical-smith" in wanted:
        found.append(Source(_under(case, PHYSICAL), "model", {"physical-smith": "global"}))
    if entry.split_model:
        fresnel = {"fresnel": "exact"}
        for name, fields in zip(
            MODEL_STEPS, (fresnel, fresnel | {"kd": "interface"}), strict=False
        ):
            model = Model(**case.model.model_dump() | fields)
            found.append(Source(_under(case, model), "model", {name: "global"}, judged=False))
    return found


def _under(case: Case, model: Model) -> Case:
    """The case under another model."""
    return case.model_copy(update={"model": model})


def _run_entry(
    job: Job, entry: Entry, report: Reporter, checks: parity.Checks
) -> tuple[CaseRecord, list[Row], list[Ladder]]:
    """One case: all its candidates, then reference by reference, then the causes of error."""
    case = entry.case
    _check_visible(case, job.path)
    frames, failures = _draw(job, entry, report)
    rows: list[Row] = []
    exposures: dict[str, float] = {}
    truths: dict[str, list[Frame]] = {}
    views: dict[str, Truth] = {}
    for source in sources(entry):
        report.step(f"{case.id}: compare with {', '.join(source.truths)}")
        judged: list[Row] = []

        def enough(batches: list[Frame], source: Source = source) -> bool:
            nonlocal exposures, judged
            exposures = exposures or exposures_of(case, batches)
            judged = []
            for name, own in source.truths.items() if source.judged else ():
                views[name] = Truth(case, name, [truth_of(b, own) for b in batches], exposures)
                rules = job.suite.budget
                judged += judged_rows(case, views[name], frames, failures, rules, job.family)
            return all(gate.settled(r) for r in judged)

        def traced(done: int, wanted: int, source: Source = source) -> None:
            named = " and ".join(source.truths)
            report.detail(f"{case.id}: trace {named}, batch {done} of {wanted}")

        batches = grow(
            source.case,
            source.kind,
            job.suite.reference,
            enough,
            Store(job.store),
            traced,
            job.executor,
            job.frozen,
        )
        if source.judged and (not judged or judged[0].reference_batches != len(batches)):
            enough(batches)  # at the cap `grow` does not ask
        rows += judged
        for name, own in source.truths.items():
            truths[name] = [truth_of(b, own) for b in batches]
    if job.brief:  # of what meets its budget no more is said
        told = {(r.technique, r.object) for r in rows if r.verdict in ("fail", "inconclusive")}
    else:
        told = {(r.technique, r.object) for r in rows}
    report.detail(f"{case.id}: measure further, and tell causes")
    further = measured_further(case, views, frames, [r for r in rows if _about(r) in told])
    rows = [r for r in rows if _about(r) not in told] + further
    ladders = _ladders(job, entry, frames, truths, further)
    for label, frame in frames.items():
        for name in entry.truths:
            own = [r for r in rows if (r.technique, r.truth) == (label, name)]
            checks.add_frame(case, label, frame, truths[name][0], own)
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


def _about(row: Row) -> tuple[str, str]:
    return row.technique, row.object


def _ladders(
    job: Job,
    entry: Entry,
    frames: dict[str, Frame],
    truths: dict[str, list[Frame]],
    rows: list[Row],
) -> list[Ladder]:
    """Error by cause for every object and technique that has rows, where there are the truths."""
    made = []
    for label, frame in frames.items():
        if not any(r.technique == label for r in rows):
            continue
        drawn = Drawn(frame.rgb)
        if not job.outside:
            thrown = switched(technique(label), entry.case.model)
            pictures = {n: Renderer(t, repeats=0).render(entry.case).rgb for n, t in thrown.items()}
            drawn = Drawn(frame.rgb, pictures.pop("specular"), pictures)
        for obj in entry.case.judged:
            own = [r for r in rows if _about(r) == (label, obj.name)]
            if own and (found := ladder(entry.case, obj, label, drawn, truths, own)):
                made.append(found)
    return made


def _check_physical(entry: Entry, material: Material, path: Path) -> None:
    """Refuse exact Fresnel for a metal of unknown eta and k, before anything is drawn."""
    if material.metallic == 0 or material.metal.eta is not None:
        return
    problem = f"'{material.name}' gives its metal as F0 alone, without eta and k"
    if entry.split_model or any(t.startswith("physical") for t in entry.truths):
        raise InputError(path, "truths: physical", problem, "name a metal, or leave `physical` out")
    if entry.case.model.fresnel == "exact":
        raise InputError(path, "model.fresnel", problem, "name a metal, or use 'schlick'")


def _check_visible(case: Case, path: Path) -> None:
    """Refuse a judged object that nobody can see, before anything is traced for it."""
    ids = object_ids(case)
    for obj in case.judged:
        if not (ids == case.index(obj.name)).any():
            problem = f"covers no pixel of {case.id}"
            remedy = "move it or the camera, or set judged = false"
            raise InputError(path, f"object '{obj.name}'", problem, remedy)


def _draw(job: Job, entry: Entry, report: Reporter) -> tuple[dict[str, Frame], dict[str, str]]:
    """The pictures of every candidate by technique, and why some gave none."""
    frames, failures = {}, {}
    for label, candidate in job.candidates(entry).items():
        report.step(f"{entry.case.id}: {label}")
        try:
            frames[label] = candidate.render(entry.case)
        except CandidateError as error:
            failures[label] = str(error)
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


def references(job: Job, samples: int) -> list[tuple[str, str, int, float]]:
    """Path-trace every reference of a job to at least `samples` per pixel.

    Returns:
        Per reference: case, truths, samples per pixel, seconds of path tracing in total.
    """
    sampling, store = job.suite.reference, Store(job.store)
    if not job.frozen:
        most = sampling.max_samples // sampling.samples_per_batch
        reached = math.ceil(samples / rounded_samples(sampling.samples_per_batch))
        trace_ahead(job, max(min(reached, most), FEWEST_BATCHES))
    done = []
    for source in (s for e in job.entries for s in sources(e)):
        case, kind = source.case, source.kind
        stored = grow(case, kind, sampling, lambda _: True, store, None, job.executor, job.frozen)
        spp = sum(b.provenance["samples"] for b in stored)
        named = ", ".join(source.truths)
        done.append((case.id, named, spp, sum(b.seconds for b in stored)))
    return done


def trace_ahead(job: Job, count: int) -> None:
    """See to it that every reference of a job has `count` batches, all submitted at once."""
    _make_folder(job.store, "--store")
    store, sampling = Store(job.store), job.suite.reference
    needed = [s for e in job.entries for s in sources(e)]
    tasks = lacking([(s.case, s.kind, sampling, count) for s in needed], store)
    with reporting(len(tasks)) as report:

        def stored(task: Task) -> None:
            report.step(f"{task.case.id}: {task.kind}, batch {task.number} is stored")

        prefetch(tasks, store, job.executor, stored)


def pools(job: Job) -> list[Pool]:
    """Each case's `global` batches at the cap of samples, and eight of one sample per pixel."""
    made = []
    with reporting(len(job.entries)) as report:
        for entry in job.entries:
            case = entry.case
            report.step(f"{case.id}: trace a pool of batches")

            def traced(done: int, wanted: int, name: str = case.id) -> None:
                report.detail(f"{name}: batch {done} of {wanted}")

            frames = grow(
                case, "model", job.suite.reference, lambda _: False, Store(job.store), traced
            )
            coarse = np.stack([render_batch(case, "model", 1, seed).rgb for seed in range(8)])
            obj = case.judged[0]
            mask = frames[0].ids == case.index(obj.name)
            batches = np.stack([frame.rgb for frame in frames])
            made.append(Pool(obj.material.name, batches, mask, coarse))
    return made


def _clear(out: Path) -> None:
    """Remove an earlier run's results: a run that fails must not leave their verdict standing."""
    if (out / "results.json").is_file():
        for name in ("frames", "truths"):
            shutil.rmtree(out / name, ignore_errors=True)
    for name in ("results.json", "report.html", "junit.xml", "summary.md"):
        (out / name).unlink(missing_ok=True)


def _make_folder(folder: Path, option: str) -> None:
    """Make a folder before any work is done for it, and see that it can be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        remedy = "choose a folder that can be written"
        problem = f"cannot be written ({error.strerror})"
        raise InputError(option, str(folder), problem, remedy) from error


def _provenance() -> dict[str, Any]:
    """Where and with what this ran."""
    return {
        "device": device().name,
        "opengl": device().version,
        "hardware_gpu": device().hardware,
        "machine": f"{platform.machine()}, {platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "versions": {p: metadata.version(p) for p in PACKAGES},
    }


def _matches(name: str, pattern: str) -> bool:
    """Whether a case is chosen: a shell pattern, or any part of its name."""
    return not pattern or fnmatch.fnmatchcase(name, pattern) or pattern in name


def plan(job: Job) -> list[str]:
    """What `run` would do, a line each: pictures to draw and samples to trace."""
    lines, store = [], Store(job.store)
    for entry in job.entries:
        case, names = entry.case, ", ".join(job.candidates(entry))
        lines.append(
            f"{case.id}: {case.width}x{case.height}, {len(case.judged)} objects, draw {names}"
        )
        for source in sources(entry):
            batches = store.load(source.case, source.kind, job.suite.reference)
            there = sum(b.provenance["samples"] for b in batches)
            most, named = job.suite.reference.max_samples, ", ".join(source.truths)
            lines.append(
                f"  {named}: {there} samples per pixel in the store, at most {most} needed"
            )
    return lines


def bench(job: Job) -> list[Timing]:
    """Warm frame times of every technique beside one path-traced sample per pixel."""
    timings = []
    with reporting(sum(1 + len(e.techniques) for e in job.entries)) as report:
        for entry in job.entries:
            case = entry.case
            report.step(f"{case.id}: Mitsuba at 1 sample per pixel")
            sample = seconds_per_sample(case)
            for name in entry.techniques:
                report.step(f"{case.id}: {name}")
                frame = Renderer(technique(name), repeats=9).render(case)
                made = frame.provenance["precomputation_seconds"]
                timings.append(
                    Timing(case.id, case.width, case.height, name, frame.seconds, made, sample)
                )
    return timings


def efficiency(job: Job) -> list[Efficiency]:
    """Time to the same intervals, ours beside the plain path tracer's."""
    from reference.plain import plain_batches

    found, samples = [], job.suite.reference.samples_per_batch
    truths = TRUTHS["model"]
    with reporting((1 + len(truths)) * len(job.entries)) as report:
        for entry in job.entries:
            case = entry.case
            label, candidate = next(iter(job.candidates(entry).items()))
            report.step(f"{case.id}: ours, beside {label}")
            frame = candidate.render(case)
            render_batch(case, "model", samples, 0)  # compiles and warms up
            batches = [render_batch(case, "model", samples, 1 + k) for k in range(FEWEST_BATCHES)]
            ours = {t: [truth_of(b, t) for b in batches] for t in truths}
            taken, plain = rounded_samples(samples), {}
            for truth in truths:
                report.step(f"{case.id}: plain path tracing of {truth}")
                plain[truth] = plain_batches(case, truth, taken, FEWEST_BATCHES)
            found += efficiencies(case, frame, ours, plain)
    return found


def _beside_oracle(material: Material, model: Model) -> Agreement:
    """The GLSL BRDF of a material beside double precision."""
    wi, wo = directions(material.alpha)
    ours = probe.brdf_values(material, wi, wo, model)
    theirs = oracle(material, wi, wo, model.masking)
    return agreement(material, model.masking, "double precision", ours, theirs, wi, wo)


def stability() -> list[Agreement]:
    """The GLSL BRDF beside double precision and Mitsuba, over maskings, alphas and weights."""
    found = []
    surfaces = [(Model(masking=masking), m) for masking in MASKINGS for m in materials()]
    with reporting(len(surfaces)) as report:
        for model, material in surfaces:
            share = f"GGX share {material.weight:g}"
            report.step(f"masking {model.masking}, alpha {material.alpha:g}, {share}")
            wi, wo = directions(material.alpha)
            ours = probe.brdf_values(material, wi, wo, model)
            theirs = reference_probe.brdf_values(material, wi, wo, model)
            found.append(_beside_oracle(material, model))
            found.append(agreement(material, model.masking, "Mitsuba", ours, theirs, wi, wo))
    return found
