"""A run that is about to be made beside an earlier one."""

from pathlib import Path

from reports.change.runs import changes_between
from reports.gate import conclude
from reports.results import Results, load_results
from scenes.errors import InputError


def load_earlier(path: Path, out: Path) -> Results:
    """Read the results of an earlier run.

    Raises:
        InputError: they cannot be read, or lie where the new run will write over their frames.
    """
    found = load_results(path)
    if path.resolve().parent == out.resolve():
        problem = "lies in --out, which this run writes over"
        raise InputError(path, "", problem, "keep a copy of that folder, or choose another --out")
    return found


def since(results: Results, out: Path, earlier: Results, path: Path, judged: bool) -> Results:
    """The results with what changed since an earlier run, and the verdict if that is judged."""
    new = out / "results.json"
    changed = changes_between(earlier, path, results, new, judged)
    return conclude(results.model_copy(update={"changed": changed}))
