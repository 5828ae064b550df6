"""The attack: changed renderers, one after the other, before the gate of a suite."""

import datetime
import time
from collections.abc import Callable
from pathlib import Path

from reference.pack import unpack
from reference.store import Store
from reports.attack.harness import attack
from reports.attack.kept import Kept
from reports.attack.mutants import Change
from reports.attack.results import Attack, Mutant
from reports.run.provenance import provenance
from reports.run.shipped import shipped_pack
from scenes.errors import InputError
from scenes.suite import load_suite


def shipped(suite: str, store: Path) -> Path:
    """Bless the references that come with the code for a suite, in a store of their own.

    Raises:
        InputError: there are none, or no such suite.
    """
    pack = shipped_pack(load_suite(suite)[1])
    if pack is None:
        problem, remedy = "comes without references", "give a --store that has them"
        raise InputError("--suite", suite, problem, remedy)
    unpack(pack, Store(store))
    return store


def kept_in(out: Path, suite: str, store: Path | None) -> Kept:
    """The verdicts that an interrupted attack on the same sources left in a folder."""
    told = {"suite": load_suite(suite)[0].model_dump(mode="json"), "store": str(store)}
    return Kept(out, told | provenance())


def attack_suite(
    suite: str,
    store: Path,
    changes: list[Change],
    jobs: int,
    told: Callable[[Mutant], None],
    kept: Kept | None = None,
    **about: str | int,
) -> Attack:
    """The gate's verdicts on changed renderers.

    Args:
        told: called with each verdict as it comes.
        kept: verdicts that are known, and where those that come are kept.
        about: the fields of Attack that say what was chosen, and by which command.
    """
    start, known = time.perf_counter(), {}
    if kept:
        asked = {c.id for c in changes}
        known = {name: m for name, m in kept.read().items() if name in asked}
        kept.begin(known)

    def judged(mutant: Mutant) -> None:
        if kept:
            kept.add(mutant)
        told(mutant)

    for mutant in known.values():
        told(mutant)
    left = [c for c in changes if c.id not in known]
    found = known | {m.id: m for m in attack(left, suite, store, jobs, judged)}
    return Attack(
        created=datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        seconds=time.perf_counter() - start,
        suite=suite,
        provenance=provenance(),
        mutants=[found[c.id] for c in changes],
        **about,
    )
