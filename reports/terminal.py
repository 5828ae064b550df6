"""What the terminal shows: materials down, weights across."""

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from reports.gate import worst_first
from reports.results import Results, Row

STYLE = {"pass": "green", "fail": "red", "inconclusive": "yellow", "reported": "dim"}


def print_results(results: Results, console: Console) -> None:
    """One table per run: local energy error, energy error and SSIM of every row."""
    weights = sorted({r.weight for r in results.rows}, reverse=True)
    table = Table(
        box=box.SIMPLE_HEAD, title=f"{results.suite}: {results.description}", title_style=""
    )
    for heading in ("scene", "environment", "material", "technique", "truth"):
        table.add_column(heading, overflow="fold")
    for weight in weights:
        table.add_column(f"GGX share {weight:g}", justify="right", no_wrap=True)
    lines: dict[tuple[str, ...], dict[float, list[Row]]] = {}
    for row in results.rows:
        key = (row.scene, row.environment, _label(row), row.technique, row.truth)
        lines.setdefault(key, {}).setdefault(row.weight, []).append(row)
    for key, cells in lines.items():
        table.add_row(*key, *(_cell(cells.get(weight, [])) for weight in weights))
    console.print(table)
    console.print("Each cell: local energy error, energy error, SSIM.", style="dim")
    print_verdict(results, console)


def print_verdict(results: Results, console: Console) -> None:
    """The verdict in one line, then why."""
    style = STYLE[results.verdict]
    counts = [f"{sum(r.verdict == v for r in results.rows)} {v}" for v in STYLE]
    console.print(f"[{style} bold]{results.verdict.upper()}[/]: {', '.join(counts)}")
    for reason in results.reasons:
        console.print(f"  {reason}", markup=False)
    for row in worst_first(results.rows)[:3]:
        if row.verdict != "reported":
            console.print(Text(f"  {describe(row)}", style=STYLE[row.verdict]))


def describe(row: Row) -> str:
    """One row in one line."""
    place = f"{row.object} ({row.material}, GGX share {row.weight:g}) in {row.case}"
    against = f"{row.technique} against {row.truth}"
    if row.problem:
        return f"{row.verdict}: {place}, {against}: {row.problem}"
    limits = ", ".join(
        f"{m} {_figure(m, getattr(row, m))} of {_figure(m, v)}" for m, v in row.budget.items()
    )
    return f"{row.verdict}: {place}, {against}: {limits}" + (f" ({row.note})" if row.note else "")


def _figure(metric: str, value: float) -> str:
    return f"{value:.1%}" if metric.startswith("energy") else f"{value:.3f}"


def _label(row: Row) -> str:
    """The object, and its material where the name does not say it."""
    name = row.material if row.object == row.material else f"{row.object}: {row.material}"
    return f"{name} r={row.roughness:g}"


def _cell(rows: list[Row]) -> Text:
    text = Text()
    for row in rows:
        if text:
            text.append("\n")
        shown = (
            row.problem
            if row.problem
            else f"{row.energy_local:.1%} {row.energy_error:+.1%} {row.ssim:.3f}"
        )
        text.append(shown, style=STYLE[row.verdict])
    return text
