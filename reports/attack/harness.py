"""Runs the real gate, as a process of its own, on a changed copy of the renderer."""

import shutil
import signal
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict
from pathlib import Path

from reports.attack.gates import OUT_OF_TIME, Gates
from reports.attack.mutants import RENDERER, Change
from reports.attack.results import Mutant, Outcome
from reports.gate import LOWER, worst_first
from reports.results import Results, load_results
from scenes.errors import InputError

ROOT = RENDERER.parent
# Appended to the copy: proof that it is what was imported.
PROOF = "\n__import__('pathlib').Path(__file__).with_name('imported').touch()\n"
# What a driver that is led astray dies of; any other signal came from outside.
SIGNALS = "SIGSEGV", "SIGABRT", "SIGFPE", "SIGILL", "SIGBUS"
CRASHES = {-signal.Signals[name] for name in SIGNALS}
MACHINE = ("error: memory: ", "cannot be used (")  # see reports/cli/main.py


def attack(
    changes: list[Change],
    suite: str,
    store: Path,
    jobs: int,
    told: Callable[[Mutant], None],
) -> list[Mutant]:
    """The gate's verdict on each change, in order; `jobs` processes at a time.

    Whatever ends it early kills the gates that run.

    Args:
        suite: whose references the store holds.
        told: called with each verdict as it comes.

    Raises:
        InputError: the gate fails where nothing is changed, or cannot run.
    """
    gates = Gates()
    with ThreadPoolExecutor(jobs) as pool:
        try:
            nothing = Change("nothing", "control", "", "__init__.py", 1, "", "")
            unchanged = pool.submit(run, nothing, suite, store, gates).result()
            if unchanged.outcome != "passed":
                problem = f"the gate fails where nothing is changed: {unchanged.by}"
                raise InputError("--suite", suite, problem, "mend that first")
            running = [pool.submit(run, change, suite, store, gates) for change in changes]
            for done in as_completed(running):
                told(done.result())
            return [done.result() for done in running]
        except BaseException:
            gates.end()
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def run(change: Change, suite: str, store: Path, gates: Gates | None = None) -> Mutant:
    """Change a copy of the renderer, put it first on the path, and ask the gate.

    Raises:
        InputError: the gate could not run, for no fault of the change.
    """
    start = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="shadeproof-") as name:
        home = Path(name)
        copy = home / "renderer"
        shutil.copytree(RENDERER, copy, ignore=shutil.ignore_patterns("__pycache__"))
        change.apply(copy)
        with (copy / "__init__.py").open("a", encoding="utf-8") as file:
            file.write(PROOF)
        words = ["gate", "--verdict-only", "--suite", suite, "--frozen", "--store", store.resolve()]
        words += ["--out", home / "out"]
        code, said = (gates or Gates()).run([str(w) for w in words], [home, ROOT], home)
        if code in (0, 1) and not (copy / "imported").exists():
            raise RuntimeError("the gate did not import the changed renderer")
        outcome, by = _outcome(change, code, said, home / "out/results.json")
    fields = asdict(change) | {"outcome": outcome, "exit_code": code, "by": by}
    return Mutant(**fields, seconds=time.perf_counter() - start)


def _outcome(change: Change, code: int, said: str, path: Path) -> tuple[Outcome, str]:
    if code == 0:
        return ("passed" if change.kind == "control" else "survived"), ""
    if code == 1:
        results = load_results(path)
        return ("alarm" if change.kind == "control" else "caught"), first_reason(results)
    if code == OUT_OF_TIME:
        return "timeout", said
    if code in CRASHES:
        return "stillborn", f"crashed: {signal.Signals(-code).name}"
    if code != 2 or any(words in said for words in MACHINE):
        problem = f"the gate could not run (exit code {code}): {said}"
        raise InputError("attack", change.id, problem, "mend that, and run again")
    return "stillborn", said.removeprefix("error: ")


def first_reason(results: Results) -> str:
    """What failed: how many rows with the worst, and every check with its figure."""
    failed = [r for r in worst_first(results.rows) if r.verdict == "fail"]
    told = []
    if failed:
        row = failed[0]
        place = f"{row.object} in {row.case}, {row.technique}"
        told.append(f"{len(failed)} of {len(results.rows)} rows, worst {place}: {_figure(row)}")
    checks = results.provenance.get("parity", ())
    told += [f"{c['name']}: {c['detail']}" for c in checks if c.get("judged") and not c["passed"]]
    return "; ".join(told) or "; ".join(results.reasons)


def _figure(row) -> str:
    """The figure of a row that misses its budget by most."""
    if row.problem:
        return row.problem
    metric = min(row.margins, key=lambda m: row.margins[m])
    bound = "at least" if metric in LOWER else "at most"
    return f"{metric} {getattr(row, metric):.3g}, {bound} {row.budget[metric]:.3g}"
