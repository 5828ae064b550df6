"""What the terminal shows of the stability checks."""

import math

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table

from reports.stability.answers import Answer, Judged
from reports.stability.promise import HARD_HOLDS
from reports.stability.results import HardCase, Map, Promise, Stability


def print_stability(found: Stability, console: Console) -> None:
    """A line a map, worst first within its verdict; hard cases that fail; what is promised."""
    table = Table(box=box.SIMPLE_HEAD, title="The shaders on hard inputs, worst of each map")
    for heading in ("", "function", "must hold", "masking"):
        table.add_column(heading)
    for heading in ("worst", "allowed", "beyond"):
        table.add_column(heading, justify="right")
    for m in sorted(found.maps, key=lambda m: m.passed):
        beyond = f"{m.beyond.value:.3g}" if m.beyond else ""
        row = (m.function, m.invariant, m.masking, f"{m.worst.value:.6g}", _allowed(m), beyond)
        table.add_row(_mark(m.passed, m.limit is not None), *row)
    console.print(table)
    for m in found.maps:
        if not m.passed:
            console.print(f"  {m.worst.command}", markup=False, soft_wrap=True)
    print_hard([case for case in found.hard if not case.passed], console)
    held = sum(case.passed for case in found.hard)
    console.print(f"{held} of {len(found.hard)} hard cases hold")
    for p in found.domain:
        bounds = ", ".join(f"{n} {low:g} to {high:g}" for n, (low, high) in p.bounds.items())
        told = promised(p, len(found.hard))
        console.print(f"{_mark(p.held)} {p.claim}: {told}", soft_wrap=True)
        if bounds:
            console.print(f"       for {bounds}", style="dim", markup=False, soft_wrap=True)


def promised(p: Promise, hard: int) -> str:
    """How well a promise is held; a share of light by what it is over 1."""
    if p.claim == HARD_HOLDS:
        return f"{hard - int(p.worst)} of {hard}"
    if 0 < abs(p.worst - 1) < 0.1:
        return f"worst 1 {'+' if p.worst > 1 else '-'} {abs(p.worst - 1):.2g}"
    return f"worst {p.worst:.3g}"


def print_hard(cases: list[HardCase], console: Console) -> None:
    """Each hard case: what must hold, and what was measured."""
    for case in cases:
        console.print(f"{_mark(case.passed)} {case.name}: {case.must_hold}", soft_wrap=True)
        for words, figure in case.measured.items():
            console.print(f"       {words}: {figure:.3g}", markup=False, soft_wrap=True)


def print_points(texts: list[str], answers: list[Answer], console: Console) -> None:
    """What each side makes of each point, and its figures with what they may be."""
    for text, answer in zip(texts, answers, strict=True):
        console.print(text, style="bold", markup=False, soft_wrap=True)
        width = max(len(what) for what, _ in answer.sides)
        for what, numbers in answer.sides:
            shown = "  ".join(f"{x:.9g}" for x in np.ravel(numbers))
            console.print(f"  {what:{width}}  {shown}", markup=False, soft_wrap=True)
        for f in answer.figures:
            allowed = "no limit here" if f.limit is None else f"allowed {_range(f)}"
            mark = _mark(f.passed, f.limit is not None or not f.passed)
            console.print(f"{mark} {f.words}: {f.value:.6g}, {allowed}", soft_wrap=True)


def _range(f: Judged) -> str:
    return f"{f.limit:g}" if f.at_least == -math.inf else f"{f.at_least:g} to {f.limit:g}"


def _allowed(m: Map) -> str:
    if m.limit is None:
        return "reported"
    return f"{m.limit:g}" if m.at_least is None else f"{m.at_least:g} to {m.limit:g}"


def _mark(passed: bool, judged: bool = True) -> str:
    if not judged:
        return "[dim]told[/]"
    return "[green]ok[/]  " if passed else "[red]off[/] "
