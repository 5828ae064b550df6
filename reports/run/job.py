"""What to run: a suite resolved into cases, candidates and references."""

import copy
import fnmatch
import tempfile
from collections.abc import Iterable
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from reference.executor import check_address, connect
from reference.settings import TRUTHS, Kind
from renderer.techniques import technique
from reports import gate
from reports.candidates import OUTSIDE, Candidate
from reports.ladder import MODEL_STEPS
from reports.results import Missing
from reports.run.own_truths import restricted
from reports.run.shots import Shot, drawn_model, shots
from scenes.environment import load_environment
from scenes.errors import InputError
from scenes.mesh import placement
from scenes.schema import PHYSICAL, Case, Material, Model, model_steps
from scenes.suite import Entry, Sampling, Suite, expand, load_suite


@dataclass(frozen=True)
class Job:
    """What to run: a suite, which of its cases, with which candidates, and where to.

    Attributes:
        frozen: use the references that are stored, and trace nothing.
        cluster: the Dask scheduler whose workers trace their batches; this process if None.
        brief: of what meets its budget, measure no more than the verdict needs.
        verdict_only: of nothing measure more than that, and time nothing.
        truth: a folder of one's own references, which stand for all others.
        ours: beside an outside candidate draw the suite's own techniques, too.
    """

    suite_name: str
    out: Path
    store: Path
    filter: str = ""
    outside: Candidate | None = None
    command: str = ""
    frozen: bool = False
    cluster: str | None = None
    brief: bool = False
    verdict_only: bool = False
    truth: Path | None = None
    ours: bool = False
    suite: Suite = field(init=False)
    path: Path = field(init=False)
    entries: list[Entry] = field(init=False)
    skipped: list[str] = field(init=False)
    whole: list[Entry] = field(init=False)
    asked: dict[str, Entry] = field(init=False)  # by case, with truths that nobody gave

    def __post_init__(self) -> None:
        if self.cluster is not None:
            check_address(self.cluster)
            if self.frozen:
                problem, remedy = "--frozen traces nothing", "leave one of them out"
                raise InputError("--cluster", self.cluster, problem, remedy)
        suite, path = load_suite(self.suite_name)
        whole = expand(suite, path)
        entries = [e for e in whole if _matches(e.case.id, self.filter)]
        skipped = [e.case.id for e in whole if e not in entries]
        if not entries:
            raise InputError(
                "--filter", self.filter, "no case matches", "see `shadeproof compare --list`"
            )
        for name in {t for e in entries for t in e.techniques}:
            try:
                technique(name)
            except ValueError as error:
                raise InputError(path, "techniques", str(error), "use a known technique") from error
        for entry in entries if self.draws else []:
            materials = [o.material for o in entry.case.objects]
            for name in entry.techniques:
                if what := technique(name).cannot_draw(entry.case.model, materials):
                    problem = f"'{name}' cannot draw {what}"
                    field = f"model.{what.split()[0]}"
                    raise InputError(path, field, problem, "leave it out, or give a --candidate")
        for entry in entries:
            load_environment(entry.case.environment.path)
            for obj in entry.case.objects:
                placement(obj)
                _check_physical(entry, obj.material, path)
        gate.check_rules(suite.budget, whole, self.drawn_model, OUTSIDE, path)
        asked = entries
        if self.truth:
            entries = [restricted(e, self.truth) for e in entries]
            whole = entries
        object.__setattr__(self, "asked", {e.case.id: e for e in asked})
        object.__setattr__(self, "suite", suite)
        object.__setattr__(self, "path", path)
        object.__setattr__(self, "entries", entries)
        object.__setattr__(self, "whole", whole)
        object.__setattr__(self, "skipped", [f"{i} (filter '{self.filter}')" for i in skipped])

    def without_budgets(self) -> "Job":
        """The same job, in which no row has a budget."""
        bare = copy.copy(self)
        object.__setattr__(bare, "suite", self.suite.model_copy(update={"budget": []}))
        return bare

    @cached_property
    def executor(self) -> Executor | None:
        """What traces the batches, if not this process."""
        return connect(self.cluster) if self.cluster else None

    @property
    def draws(self) -> bool:
        """Whether our own renderer draws."""
        return self.ours or not self.outside

    def labels(self, entry: Entry) -> tuple[str, ...]:
        """The techniques that an entry's rows name; who is outside comes first."""
        outside = (OUTSIDE,) if self.outside else ()
        return (*outside, *entry.techniques) if self.draws else outside

    @property
    def family(self) -> int:
        """How many verdicts must hold together: the whole suite's, at every look at its batches."""
        return gate.family_size(
            self.suite.budget, self.whole, self.suite.reference, self.drawn_model, self.labels
        )

    @property
    def wanted(self) -> list[tuple[Case, Kind, Sampling]]:
        """Every reference that it needs."""
        if self.truth:
            return []
        return [(s.case, s.kind, self.suite.reference) for e in self.entries for s in sources(e)]

    def sources(self, entry: Entry) -> "list[Source]":
        """Every reference of an entry, traced here or one's own."""
        return own_sources(entry) if self.truth else sources(entry)

    def shots(self, entry: Entry, truths: Iterable[str]) -> dict[str, dict[str, Shot]]:
        """What is drawn of an entry's case to stand against some truths: by technique and truth."""
        timed, drawn = not self.verdict_only, {}
        for name in self.labels(entry):
            if name == OUTSIDE:
                drawn[name] = dict.fromkeys(truths, Shot(name, self.outside, entry.case))
            else:
                drawn[name] = shots(name, entry.case, truths, timed)
        return drawn

    def pictures(self, entry: Entry) -> dict[str, Shot]:
        """Every picture that is drawn of an entry's case, by name."""
        by_truth = self.shots(entry, entry.truths).values()
        return {shot.name: shot for own in by_truth for shot in own.values()}

    def drawn_model(self, entry: Entry, name: str, truth: str) -> Model:
        """The model of the picture that a technique, or who is outside, sets against a truth."""
        model = entry.case.model
        return model if name == OUTSIDE else drawn_model(technique(name), model, truth)

    def expected(self, entries: list[Entry]) -> list[Missing]:
        """Every row that the suite asks for in some of its entries.

        Of one's own truths those that there are, and those that a budget asks for.
        """
        rows = [
            Missing(case=e.case.id, object=o.name, technique=t, truth=truth)
            for e in entries
            for t in self.labels(e)
            for truth in self.asked.get(e.case.id, e).truths
            for o in e.case.judged
        ]
        given = {(e.case.id, truth) for e in entries for truth in e.truths}
        owed = {row for e in self.asked.values() for row in self._budgeted(e)}
        return [r for r in rows if (r.case, r.truth) in given or r.key in owed]

    def _budgeted(self, entry: Entry) -> Iterable[tuple[str, str, str, str]]:
        """The keys of an entry's rows that have a budget."""
        labels = self.labels(entry)
        for row in gate.budgeted(self.suite.budget, entry, labels, self.drawn_model):
            yield entry.case.id, *row


def _matches(name: str, pattern: str) -> bool:
    """Whether a case is chosen: a shell pattern, or any part of its name."""
    return not pattern or fnmatch.fnmatchcase(name, pattern) or pattern in name


def _check_physical(entry: Entry, material: Material, path: Path) -> None:
    """Refuse exact Fresnel where eta and k are unknown, before anything is drawn."""
    if material.metallic > 0 and material.metal.eta is None:
        problem = f"'{material.name}' gives its metal as F0 alone, without eta and k"
        remedy = "name a metal"
    elif material.metallic < 1 and material.f0.eta is None:
        problem = f"'{material.name}' has an F0 of 1, which no eta gives"
        remedy = "give f0 below 1"
    else:
        return
    if entry.split_model or any(t.startswith("physical") for t in entry.truths):
        raise InputError(path, "truths: physical", problem, f"{remedy}, or leave `physical` out")
    if entry.case.model.fresnel == "exact":
        raise InputError(path, "model.fresnel", problem, f"{remedy}, or use 'schlick'")


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
        # The third step, masking, ends at `physical` itself.
        for name, model in zip(MODEL_STEPS[:2], model_steps(case.model)[:2], strict=True):
            found.append(Source(_under(case, model), "model", {name: "global"}, judged=False))
    return found


def own_sources(entry: Entry) -> list[Source]:
    """One's own references of an entry, a truth each; `global`, which sets the exposure, first."""
    ordered = sorted(entry.truths, key=lambda truth: truth != "global")
    return [Source(entry.case, "model", {truth: truth}) for truth in ordered]


def _under(case: Case, model: Model) -> Case:
    """The case under another model."""
    return case.model_copy(update={"model": model})


def make_folder(folder: Path, option: str) -> None:
    """Make a folder before any work is done for it, and see that it can be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        remedy = "choose a folder that can be written"
        problem = f"cannot be written ({error.strerror})"
        raise InputError(option, str(folder), problem, remedy) from error
