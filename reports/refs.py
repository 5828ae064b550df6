"""The commands `shadeproof refs`: tell, pack, unpack and verify references."""

import math
from pathlib import Path

import typer
from rich import box
from rich.console import Console
from rich.table import Table

from reference.batches import all_stored
from reference.pack import pack, unpack
from reference.store import Record, Store, mending
from reference.verify import FAMILY_ERROR, Check, verify
from reports.progress import reporting
from reports.run.job import Job
from scenes.errors import InputError

STYLE = {"current": "green", "blessed": "cyan", "other code": "dim", "other packages": "dim"}


def print_list(store: Path, console: Console) -> None:
    """What a store holds, a row each.

    Raises:
        InputError: there is no such store.
    """
    if not store.is_dir():
        remedy = "check the path, or trace or unpack references into it"
        raise InputError("--store", str(store), "no such folder", remedy)
    table = Table(box=box.SIMPLE_HEAD, title=f"references in {store}")
    for heading in ("case", "kind", "model"):
        table.add_column(heading)
    for heading in ("batches", "samples", "MB"):
        table.add_column(heading, justify="right")
    table.add_column("state")
    records = Store(store).records()
    for r in sorted(records, key=lambda r: (r.case, r.kind, r.model, r.state)):
        table.add_row(r.case, r.kind, r.model, *_sizes(r), f"[{STYLE[r.state]}]{r.state}[/]")
    console.print(table)
    total = sum(r.size for r in records) / 1e6
    console.print(f"{_count(len(records))}, {total:.1f} MB", soft_wrap=True)


def _count(references: int) -> str:
    return "1 reference" if references == 1 else f"{references} references"


def _sizes(record: Record) -> list[str]:
    return [str(record.batches), str(record.samples), f"{record.size / 1e6:.1f}"]


def pack_suite(job: Job, file: Path, console: Console) -> None:
    """Write a job's references into one file, and say its digest."""
    digest, manifest = pack(job.wanted, Store(job.store), file, job.path.stem)
    size = file.stat().st_size / 1e6
    console.print(f"{file}: {_count(len(manifest['references']))}, {size:.2f} MB", soft_wrap=True)
    typer.echo(f"sha256:{digest}")


def unpack_file(file: Path, digest: str, store: Path, console: Console) -> None:
    """Bless the references of a pack."""
    references = unpack(file, Store(store), digest)["references"]
    told = _count(len(references))
    are = "is" if len(references) == 1 else "are"
    console.print(f"{told} of {file} {are} blessed in {store}", soft_wrap=True)


def verify_suite(job: Job, batches: int, console: Console) -> bool:
    """Whether a job's references are sound, and agree with fresh ones.

    Where files are damaged, they are told and nothing is compared.

    Args:
        batches: fresh ones for each reference; 0 looks at the files alone.

    Raises:
        InputError: a reference is missing.
    """
    if batches == 1:
        raise InputError("--batches", "", "one batch has no spread", "give 2 or more, or 0")
    store, needed = Store(job.store), job.wanted
    damaged = store.damaged({home: None for n in needed for home in store.homes(*n)})
    for path in damaged:
        console.print(f"[red]damaged[/] {path}; {mending(path)}", soft_wrap=True)
    if damaged:
        return False
    all_stored(needed, store)
    console.print(f"[green]sound[/] every file of {_count(len(needed))}")
    if batches == 0:
        return True
    with reporting(len(needed)) as report:
        checks = verify(needed, store, batches, job.executor, report.step)
    _print_checks(checks, console)
    return all(c.agrees for c in checks)


def _print_checks(checks: list[Check], console: Console) -> None:
    table = Table(box=box.SIMPLE_HEAD, title="stored against freshly path-traced")
    for heading in ("", "case", "kind", "batches", "least likely difference", "in", "would see"):
        table.add_column(heading)
    for c in checks:
        table.add_row(
            "[green]agrees[/]" if c.agrees else "[red]differs[/]",
            c.case,
            c.kind,
            f"{c.old} + {c.new}",
            "not equal" if math.isnan(c.sigma) else f"{c.sigma:+.1f} sigma, {c.relative:+.2%}",
            c.where,
            f"{c.visible:.2%}",
        )
    console.print(table)
    console.print(
        f"All tests together refuse a sound store with a chance of {FAMILY_ERROR:g}. The last "
        "column: the bias of any one object and channel that would be seen with 95 % probability.",
        style="dim",
        soft_wrap=True,
    )
