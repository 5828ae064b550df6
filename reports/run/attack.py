"""The attack: changed renderers, one after the other, before the gate of a suite."""

import datetime
import time
from collections.abc import Callable
from pathlib import Path

from reference.pack import unpack
from reference.store import Store
from reports.attack.harness import attack
from reports.attack.mutants import Change
from reports.attack.results import Attack
from reports.run.suite import provenance
from scenes.errors import InputError
from scenes.suite import HERE


def shipped(suite: str, store: Path) -> Path:
    """Bless the references that come with the code for a suite, in a store of their own.

    Raises:
        InputError: there are none.
    """
    pack = HERE / "references" / f"{Path(suite).stem}.refs"
    if not pack.is_file():
        problem, remedy = "comes without references", "give a --store that has them"
        raise InputError("--suite", suite, problem, remedy)
    unpack(pack, Store(store))
    return store


def attack_suite(
    suite: str,
    store: Path,
    injected: list[Change],
    jobs: int,
    step: Callable[[str], None],
    **about: str | int,
) -> Attack:
    """The gate's verdicts on changed renderers.

    Args:
        step: called with a line for each verdict.
        about: the fields of Attack that say what was chosen, and by which command.
    """
    start = time.perf_counter()
    mutants = attack(
        injected, suite, store, jobs, lambda m: step(f"{m.outcome}: {m.id} {m.by}"[:160])
    )
    return Attack(
        created=datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        seconds=time.perf_counter() - start,
        suite=suite,
        provenance=provenance(),
        mutants=mutants,
        **about,
    )
