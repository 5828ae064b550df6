"""A whole suite: every case drawn, path-traced, compared and judged."""

import datetime
import shutil
import time
from pathlib import Path

from reference.settings import FEWEST_BATCHES
from reports import gate, parity
from reports.progress import reporting
from reports.results import CaseRecord, Ladder, Results, Row
from reports.run.case import run_entry
from reports.run.job import Job, make_folder
from reports.run.makers import Makers
from reports.run.own_truths import check_batches
from reports.run.provenance import provenance
from reports.run.shipped import need_stored
from reports.run.tracing import trace_ahead

JUDGED_BY = ("scikit-image", "flip-evaluator")


def run(job: Job) -> Results:
    """Draw, path-trace and compare every case of a job, and judge it.

    Frames are written to `job.out`; the results are returned, not written.
    """
    start = time.perf_counter()
    for entry in job.entries if job.truth else []:
        check_batches(job.truth, entry)
    if job.out.exists():
        make_folder(job.out, "--out")
        _clear(job.out)
    if job.frozen:
        need_stored(job)
    executor = job.executor
    make_folder(job.out, "--out")
    if executor:
        trace_ahead(job, FEWEST_BATCHES)
    elif not job.frozen:
        make_folder(job.store, "--store")
    rows: list[Row] = []
    cases: list[CaseRecord] = []
    ladders: list[Ladder] = []
    checks, makers = parity.Checks(judged=not job.outside), Makers()
    steps = sum(len(job.pictures(e)) + len(job.sources(e)) for e in job.entries)
    with reporting(steps) as report:
        for entry in job.entries:
            record, made, causes = run_entry(job, entry, report, checks, makers)
            cases.append(record)
            rows += made
            ladders += causes
    if job.draws:
        _check_ours(job, checks)
    results = Results(
        suite=job.path.stem,
        suite_path=str(job.path),
        description=job.suite.description,
        command=job.command,
        created=datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        seconds=time.perf_counter() - start,
        provenance=provenance(*JUDGED_BY, drawn=job.draws)
        | {"parity": checks.verdicts(), "references": makers.told()},
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


def _check_ours(job: Job, checks: parity.Checks) -> None:
    """Hold our own renderer's shaders, maps and samples against what they must be."""
    from reports.run.conformance import conformance  # late: see reports.run.shots
    from reports.run.stability.materials import beside_oracle

    surfaces = {(o.material, e.case.model) for e in job.entries for o in e.case.judged}
    checks.shaders += [beside_oracle(*s) for s in surfaces]
    checks.definitions += conformance(job.entries)


def _clear(out: Path) -> None:
    """Remove an earlier run's results: a run that fails must not leave their verdict standing."""
    if (out / "results.json").is_file():
        for name in ("frames", "truths", "crops", "report_files"):
            shutil.rmtree(out / name, ignore_errors=True)
    for name in ("results.json", "report.html", "junit.xml", "summary.md"):
        (out / name).unlink(missing_ok=True)
