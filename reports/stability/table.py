"""What the terminal shows of the stability checks."""

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table

from reports.stability.results import HardCase, Map, Stability

Told = list[tuple[str, np.ndarray]]


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
        console.print(f"{_mark(p.held)} {p.claim}: worst {p.worst:.3g}", soft_wrap=True)
        if bounds:
            console.print(f"       for {bounds}", style="dim", markup=False, soft_wrap=True)


def print_hard(cases: list[HardCase], console: Console) -> None:
    """Each hard case: what must hold, and what was measured."""
    for case in cases:
        console.print(f"{_mark(case.passed)} {case.name}: {case.must_hold}", soft_wrap=True)
        for words, figure in case.measured.items():
            console.print(f"       {words}: {figure:.3g}", markup=False, soft_wrap=True)


def print_points(texts: list[str], told: list[Told], console: Console) -> None:
    """What each side makes of each point; of two of one function, how far apart they are."""
    for text, sides in zip(texts, told, strict=True):
        console.print(text, style="bold", markup=False, soft_wrap=True)
        _print_sides(sides, console)
    if len(told) == 2 and len({text.split()[0] for text in texts}) == 1:
        first, second = (dict(sides)["GLSL"].astype(float) for sides in told)
        console.print("the second less the first", style="bold")
        _print_sides([("GLSL", second - first)], console)


def _print_sides(sides: Told, console: Console) -> None:
    width = max(len(what) for what, _ in sides)
    for what, numbers in sides:
        shown = "  ".join(f"{x:.9g}" for x in np.ravel(numbers))
        console.print(f"  {what:{width}}  {shown}", markup=False, soft_wrap=True)


def _allowed(m: Map) -> str:
    if m.limit is None:
        return "reported"
    return f"{m.limit:g}" if m.at_least is None else f"{m.at_least:g} to {m.limit:g}"


def _mark(passed: bool, judged: bool = True) -> str:
    if not judged:
        return "[dim]told[/]"
    return "[green]ok[/]  " if passed else "[red]off[/] "
