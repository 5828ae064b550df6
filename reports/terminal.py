"""What the terminal shows: materials down, weights across."""

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from reports.gate import worst_first
from reports.results import Results, Row

STYLE = {"pass": "green", "fail": "red", "inconclusive": "yellow", "reported": "dim"}


def print_results(results: Results, console: Console) -> None:
    """One table: materials down, weights across, a section per case, technique and truth."""
    weights = sorted({r.weight for r in results.rows}, reverse=True)
    table = Table(box=box.SIMPLE_HEAD, title=f"{results.suite}: {results.description}")
    table.add_column("material", no_wrap=True)
    for weight in weights:
        table.add_column(f"GGX share {weight:g}", justify="right", no_wrap=True)
    sections: dict[str, dict[str, dict[float, list[Row]]]] = {}
    for row in results.rows:
        heading = f"{row.case}: {row.technique} against {row.truth}"
        line = sections.setdefault(heading, {}).setdefault(_label(row), {})
        line.setdefault(row.weight, []).append(row)
    for heading, lines in sections.items():
        table.add_row(Text(heading, style="bold"))
        for label, cells in lines.items():
            table.add_row(f"  {label}", *(_cell(cells.get(weight, [])) for weight in weights))
        table.add_section()
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
    return f"{row.material}, roughness {row.roughness:g}" + (
        f", metallic {row.metallic:g}" if 0 < row.metallic < 1 else ""
    )


def _cell(rows: list[Row]) -> Text:
    text = Text()
    for row in rows:
        if text:
            text.append("\n")
        figures = f"{row.energy_local:.1%} {row.energy_error:+.1%} {row.ssim:.3f}"
        text.append(row.problem or figures, style=STYLE[row.verdict])
    return text
