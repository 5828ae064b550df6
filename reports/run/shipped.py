"""References that come with the code: the packs in scenes/references, by their suite's name."""

import sys
from pathlib import Path

from reference.batches import all_stored, lacking
from reference.pack import unpack
from reference.settings import FEWEST_BATCHES
from reference.store import Store
from reports.run.job import Job
from scenes.suite import HERE


def shipped_pack(suite: Path) -> Path | None:
    """The pack that comes with the code for one of its suites."""
    pack = HERE / "references" / f"{suite.stem}.refs"
    ours = suite.resolve().parent == (HERE / "suites").resolve()
    return pack if ours and pack.is_file() else None


def need_stored(job: Job) -> None:
    """See that a store has what a frozen job needs; what is missing comes from the shipped pack.

    Raises:
        InputError: a reference is in neither, or is damaged.
    """
    store, pack = Store(job.store), shipped_pack(job.path)
    if pack and lacking([(*needed, FEWEST_BATCHES) for needed in job.wanted], store):
        count = len(unpack(pack, store)["references"])
        what = "reference" if count == 1 else "references"
        print(f"blessed in {job.store}: {count} {what} of {pack}", file=sys.stderr, flush=True)
    all_stored(job.wanted, store)
