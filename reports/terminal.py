"""What the terminal shows: materials down, weights across, or a list of both."""

import math
from collections.abc import Sequence
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from reports.change.told import print_changes
from reports.crops import Crop
from reports.furnace import MASKINGS, Departure, EnergyClaim, Quantity
from reports.gate import headline, worst_first
from reports.html.figures import METRICS, half_width
from reports.html.template import pasted
from reports.results import Beside, Ladder, Ratio, Results, Row
from reports.telling import again, crossed, notes_of
from scenes.draw.suite import WIDER

BESIDE = ("technique", "figure", "median row", "worst row", "rows")
STYLE = {"pass": "green", "fail": "red", "inconclusive": "yellow", "reported": "dim"}


def print_results(results: Results, console: Console) -> None:
    """One table: materials down, weights across; of objects with a weight each a list.

    A section holds one scene, environment, technique and truth; cases that differ by what was
    swept share it.
    """
    table = Table(box=box.SIMPLE_HEAD, title=f"{results.suite}: {results.description}")
    table.add_column("material")
    sections: dict[str, list[Row]] = {}
    for row in results.rows:
        heading = f"{row.scene}.{row.environment}: {row.technique} against {row.truth}"
        sections.setdefault(heading, []).append(row)
    told = {heading: _lines(rows) for heading, rows in sections.items()}
    grid = crossed(
        (f"{heading} {label}", row.weight)
        for heading, lines in told.items() for label, line in lines.items() for row in line
    )  # fmt: skip
    weights = sorted({r.weight for r in results.rows}, reverse=True) if grid else []
    for title in [f"weight {weight:g}" for weight in weights] or ["weight", "figures"]:
        table.add_column(title, justify="right")
    for heading, lines in told.items():
        table.add_row(Text(heading, style="bold"))
        for label, line in lines.items():
            cells = {row.weight: _cell(row) for row in line}
            if grid:
                table.add_row(f"  {label}", *(cells.get(weight, "") for weight in weights))
            else:
                for weight in sorted(cells, reverse=True):
                    table.add_row(f"  {label}", f"{weight:g}", cells[weight])
        table.add_section()
    console.print(table)
    console.print(
        "Each cell: local energy error, energy error, SSIM. Weight: share of GGX.", style="dim"
    )
    if results.changed:
        print_changes(results.changed, console)
    print_verdict(results, console)
    if results.beside:
        print_beside(results.beside, console)


def print_beside(found: Beside, console: Console) -> None:
    """Errors as multiples of another run's: medians and worst rows of each technique and truth."""
    table = Table(box=box.SIMPLE_HEAD, title=f"How far off, beside {found.suite}")
    for heading in BESIDE[:2]:
        table.add_column(heading)
    for heading in BESIDE[2:]:
        table.add_column(heading, justify="right")
    for ratio in found.ratios:
        over = any(times > WIDER for times in (ratio.median_ratio, ratio.worst_ratio))
        table.add_row(*beside_cells(ratio), style="red" if over else "")
    console.print(table)


def beside_cells(ratio: Ratio) -> tuple[str, ...]:
    """The cells of one ratio under the headings of BESIDE."""

    def cell(ours: float, theirs: float, times: float) -> str:
        shown = f"{times:.2f} x" if math.isfinite(times) else "hidden by noise"
        return f"{shown} ({ours:.2%} of {theirs:.2%})"

    return (
        f"{ratio.technique} against {ratio.truth}",
        ratio.figure,
        cell(ratio.median, ratio.other_median, ratio.median_ratio),
        cell(ratio.worst, ratio.other_worst, ratio.worst_ratio),
        f"{ratio.rows} of {ratio.other_rows}",
    )


def _lines(rows: list[Row]) -> dict[str, list[Row]]:
    """The rows of a section by line: objects of one surface and different weights share one."""
    surfaces: dict[str, list[Row]] = {}
    for row in rows:
        surfaces.setdefault(_surface(row), []).append(row)
    lines: dict[str, list[Row]] = {}
    for surface, alike in surfaces.items():
        shared = len({row.weight for row in alike}) == len(alike)
        for row in alike:
            lines.setdefault(surface if shared else f"{row.object}: {surface}", []).append(row)
    return lines


def print_verdict(results: Results, console: Console) -> None:
    """The verdict in one line, then why, then the worst rows."""
    word = headline(results)
    counts = [f"{sum(r.verdict == v for r in results.rows)} {v}" for v in STYLE]
    console.print(f"[{STYLE[word]} bold]{word.upper()}[/]: {', '.join([*counts, *skips(results)])}")
    for reason in results.reasons:
        console.print(f"  {reason}", markup=False, soft_wrap=True)
    ranked = worst_first(results.rows)
    shared, own = notes_of(ranked)
    for row, note in zip(ranked[:3], own[:3], strict=True):
        if row.verdict != "reported":
            told = describe(row.model_copy(update={"note": note}))
            console.print(Text(f"  {told}", style=STYLE[row.verdict]), soft_wrap=True)
    if shared:
        told = f"  every row: {'; '.join(shared)}"
        console.print(told, style="dim", markup=False, soft_wrap=True)
    known = {(f.case, f.object, f.technique): f for f in results.ladders}
    places = dict.fromkeys((r.case, r.object, r.technique) for r in ranked)
    for found in [known[p] for p in places if p in known][:3]:
        console.print(f"  why: {why(found)}", style="dim", markup=False, soft_wrap=True)


def print_crops(crops: Sequence[Crop], out: Path, results: Results, console: Console) -> None:
    """Of a run that fails: the pictures of its worst rows, and the command that shows one again."""
    if results.verdict == "pass" or not crops:
        return
    for crop in crops:
        row = crop.row
        told = f"{row.object} in {row.case}, {row.technique} against {row.truth}"
        console.print(f"  picture: {out / crop.path}: {told}", soft_wrap=True, markup=False)
    if told := again(results, crops[0].row.case, out):
        console.print(f"  see it: {pasted(told)}", soft_wrap=True, markup=False)


def skips(results: Results) -> list[str]:
    """How many cases of the suite were left out, as a list of one text or none."""
    count = len(results.skipped)
    return [f"{count} case{'s' * (count > 1)} skipped"] if count else []


def why(found: Ladder) -> str:
    """The causes of one object's local energy error in one line, and what they make.

    The total comes from other batches than the causes, so that its sum is a check.
    """
    causes = [f"{c.name} {c.local.value:+.1%}" for c in found.causes if not c.parent]
    sums = "make" if found.closes else "do NOT sum to"
    local = found.total.local
    spread = _spread(100 * (local.high - local.low) / 2)
    total = f"{sums} {100 * local.value:.1f} ± {spread} % of local energy error (of other batches)"
    place = f"{found.object} in {found.case}, {found.technique} against {found.truth}"
    return f"{place}: {', '.join(causes)} {total}"


def _spread(half: float) -> str:
    """Half an interval to one digit, or whole."""
    if not math.isfinite(half):
        return "unknown"
    return f"{half:.1g}" if half < 1 else f"{half:.0f}"


def describe(row: Row) -> str:
    """One row in one line."""
    place = f"{row.object} ({row.material}, weight {row.weight:g}) in {row.case}"
    against = f"{row.technique} against {row.truth}"
    if row.problem:
        return f"{row.verdict}: {place}, {against}: {row.problem}"
    limits = ", ".join(_held(row, metric) for metric in row.budget)
    return f"{row.verdict}: {place}, {against}: {limits}" + (f" ({row.note})" if row.note else "")


def _held(row: Row, metric: str) -> str:
    """A figure against its limit; one that misses it says so, or that noise hides whether."""
    value, limit = getattr(row, metric), row.budget[metric]
    half = half_width(METRICS[metric].bounds(row))
    noise = f" ± {_figure(metric, half)}" if math.isfinite(half) else ""
    shown = f"{metric} {_figure(metric, value)}{noise} of {_figure(metric, limit)}"
    if metric in row.undecided:
        return f"{shown} undecided"
    return f"{shown} MISSED" if row.margins[metric] < 0 else shown


def _figure(metric: str, value: float) -> str:
    return f"{value * 100:.3g}%" if metric.startswith("energy") else f"{value:.4g}"


def _surface(row: Row) -> str:
    """The material, with what may have been swept or changed."""
    half = f", metallic {row.metallic:g}" if 0 < row.metallic < 1 else ""
    return f"{row.material}, roughness {row.roughness:g}{half}"


def _cell(row: Row) -> Text:
    """Local energy error, energy error and SSIM, or why there are none."""
    figures = f"{row.energy_local:.1%} {row.energy_error:+.1%} {row.ssim:.3f}"
    return Text(row.problem or figures, style=STYLE[row.verdict])


FURNACES: dict[Quantity, str] = {
    "weak": "weak furnace (1 is right)",
    "albedo": "furnace albedo, F = 1 (at most 1)",
    "surface": "white surface, F0 .04, kd 1 - F(h.wi) (at most 1)",
    "shortcut": "white surface, F0 .04, kd 1 - F(n.v) (at most 1)",
}


def print_energy_claim(claim: EnergyClaim, console: Console) -> None:
    """The least and most of each furnace, with where they are found."""
    table = Table(box=box.SIMPLE_HEAD, title="Light sent back, of light that comes alike from all")
    for heading in ("furnace", "masking"):
        table.add_column(heading)
    for heading in ("least", "most"):
        table.add_column(f"{heading}: roughness, angle, weight", justify="right")
    for quantity, name in FURNACES.items():
        for masking in MASKINGS:
            found = claim.least(quantity, masking), claim.most(quantity, masking)
            table.add_row(name, masking, *map(_departure, found))
    console.print(table)
    low, high = claim.widths_apart
    console.print(f"paper, weights of D and G apart, worst: {_departure(claim.weights_apart)}")
    console.print(f"paper, roughness of the lobes apart, weak furnace: {low:.4f} to {high:.4f}")


def _departure(found: Departure) -> str:
    return f"{found.figure:.4f}: {found.roughness:g}, {found.angle:g}°, {found.weight:g}"
