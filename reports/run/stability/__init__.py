"""The GLSL that users run, over every hard input, against float64 and Mitsuba."""

import datetime
import os
import time
from collections.abc import Iterator
from typing import Any

from reports.progress import Reporter, reporting
from reports.run.provenance import provenance
from reports.run.stability import furnaces, geometry, lookups, models, terms
from reports.run.stability.brdf import Sweep, stock_maps
from reports.run.stability.named_brdf import BRDF
from reports.run.stability.named_terms import TERMS
from reports.stability.directions import MASKINGS
from reports.stability.promise import promises
from reports.stability.results import HardCase, Map, Stability
from scenes.errors import InputError
from scenes.words import nearest

NAMED = {case.name: case for case in (*BRDF, *TERMS)}


def stability(command: str = "", frames: bool = True) -> Stability:
    """Every map, and every hard case.

    Args:
        frames: draw the hard pictures too, not only call functions.
    """
    start = time.perf_counter()
    with reporting(3 if frames else 2) as report:
        report.step("functions over their grids")
        maps = list(_maps(report))
        report.step("functions on hard inputs")
        hard = [case.case() for case in NAMED.values()]
        if frames:
            report.step("whole pictures of hard cases")
            hard += _frames()
    return Stability(
        created=datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        seconds=time.perf_counter() - start,
        command=command,
        provenance=_provenance(),
        maps=maps,
        hard=hard,
        domain=promises(maps, hard),
    )


def _maps(report: Reporter) -> Iterator[Map]:
    for masking in MASKINGS:
        yield from _told(Sweep(masking).maps(), report)
    for maps in (stock_maps(), terms.maps(), furnaces.maps()):
        yield from _told(maps, report)
    for maps in (models.maps(), geometry.maps(), lookups.maps()):
        yield from _told(maps, report)


def _told(maps: Iterator[Map], report: Reporter) -> Iterator[Map]:
    for found in maps:
        report.detail(f"{found.function} {found.masking} {found.invariant}")
        yield found


def hard_cases(names: list[str]) -> list[HardCase]:
    """The hard cases of these names, functions' or pictures'.

    Raises:
        InputError: there is no such case.
    """
    for name in names:
        if name not in (known := hard_names()):
            remedy = nearest(name, known) + "see `shadeproof stability --list`"
            raise InputError("--hard", "", f"there is no hard case '{name}'", remedy)
    found = []
    for name in names:
        found += [NAMED[name].case()] if name in NAMED else _frames([name])
    return found


def hard_names() -> list[str]:
    """Every hard case: of functions, and of pictures."""
    from reports.stability.hard import hard_cases as pictures

    return [*NAMED, *pictures()]


def _frames(names: list[str] | tuple[str, ...] = ()) -> list[HardCase]:
    from reports.run.stability.frames import hard_frames

    return hard_frames(names)


def _provenance() -> dict[str, Any]:
    from reference.variant import mitsuba

    return provenance() | {"variant": mitsuba().variant(), "cpus": os.cpu_count()}
