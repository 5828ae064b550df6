"""Runs the real gate, as a process of its own, on a changed copy of the renderer."""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from pathlib import Path

from reports.attack.mutants import RENDERER, Change
from reports.attack.results import Mutant, Outcome
from reports.gate import LOWER, worst_first
from reports.results import Results, load_results
from scenes.errors import InputError

ROOT = RENDERER.parent
TIME_LIMIT = 180  # seconds; a gate takes 8, or some times that beside others
# Appended to the copy: proof that it is what was imported.
PROOF = "\n__import__('pathlib').Path(__file__).with_name('imported').touch()\n"
TIDY = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}  # two at a time share the cores


def attack(
    injected: list[Change],
    suite: str,
    store: Path,
    jobs: int,
    told: Callable[[Mutant], None],
) -> list[Mutant]:
    """The gate's verdict on each change, in order; `jobs` processes at a time.

    Args:
        suite: whose references the store holds.
        told: called with each verdict as it comes.

    Raises:
        InputError: the gate fails where nothing is changed.
    """
    nothing = Change("nothing", "control", "", "__init__.py", 1, "", "")
    if (unchanged := run(nothing, suite, store)).outcome != "passed":
        problem = f"the gate fails where nothing is changed: {unchanged.by}"
        raise InputError("--suite", suite, problem, "mend that first")

    def one(change: Change) -> Mutant:
        mutant = run(change, suite, store)
        told(mutant)
        return mutant

    with ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(one, injected))


def run(change: Change, suite: str, store: Path) -> Mutant:
    """Change a copy of the renderer, put it first on the path, and ask the gate."""
    start = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="shadeproof-") as name:
        home = Path(name)
        copy = home / "renderer"
        shutil.copytree(RENDERER, copy, ignore=shutil.ignore_patterns("__pycache__"))
        change.apply(copy)
        with (copy / "__init__.py").open("a", encoding="utf-8") as file:
            file.write(PROOF)
        words = ["gate", "--verdict-only", "--suite", suite, "--frozen", "--store", store.resolve()]
        code, said = _gate([*map(str, words), "--out", str(home / "out")], home)
        if code in (0, 1) and not (copy / "imported").exists():
            raise RuntimeError("the gate did not import the changed renderer")
        outcome, by = _outcome(change, code, said, home / "out/results.json")
    fields = asdict(change) | {"outcome": outcome, "exit_code": code, "by": by}
    return Mutant(**fields, seconds=time.perf_counter() - start)


def _gate(words: list[str], home: Path) -> tuple[int, str]:
    """The gate's exit code (-1 where it ran out of time) and its last line of errors."""
    path = os.pathsep.join([str(home), str(ROOT)])
    command = [sys.executable, "-m", "reports.cli", *words]
    try:
        answer = subprocess.run(
            command,
            cwd=home,
            env=os.environ | TIDY | {"PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1"},
            capture_output=True,
            text=True,
            timeout=TIME_LIMIT,
        )
    except subprocess.TimeoutExpired:
        return -1, f"took more than {TIME_LIMIT} s"
    lines = answer.stderr.strip().splitlines()
    return answer.returncode, lines[-1] if lines else ""


def _outcome(change: Change, code: int, said: str, path: Path) -> tuple[Outcome, str]:
    if code == 0:
        return ("passed" if change.kind == "control" else "survived"), ""
    if code == 1:
        results = load_results(path)
        return ("alarm" if change.kind == "control" else "caught"), first_reason(results)
    return "stillborn", said


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
