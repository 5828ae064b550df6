"""What CI reads: JUnit XML, a Markdown summary, and error annotations."""

import os
import sys
from collections.abc import Sequence
from pathlib import Path

from junitparser import Error, Failure, JUnitXml, Skipped, TestCase, TestSuite

from reports.change.ranking import by_row, verdict_of
from reports.change.told import heading, worst
from reports.change.told import markdown as markdown_of_changes
from reports.crops import Crop
from reports.gate import headline, worst_first
from reports.results import Key, Results, Row
from reports.terminal import BESIDE, beside_cells, describe, skips
from scenes.frame import write_text

COLUMNS = (
    *("verdict", "case", "object", "material", "weight", "technique", "truth"),
    *("local energy", "energy", "SSIM"),
)


SHOWN = 20  # rows in the summary


def write_junit(results: Results, path: Path) -> None:
    """JUnit XML: one test per row; missing rows and the run's own reasons are failures too."""
    suite = TestSuite(f"shadeproof.{results.suite}")
    worse = _worse(results)
    for row in results.rows:
        test = TestCase(f"{row.object} {row.technique} against {row.truth}", classname=row.case)
        test.time = 0.0 if row.frame_ms != row.frame_ms else row.frame_ms / 1e3
        if told := worse.get(row.key):
            test.result = [Failure(told)]
        elif row.verdict == "fail" or (
            row.verdict == "inconclusive" and not results.allow_inconclusive
        ):
            test.result = [Failure(describe(row))]
        elif row.verdict == "reported":
            test.result = [Skipped("reported without a budget")]
        suite.add_testcase(test)
    for gap in results.missing:
        test = TestCase(f"{gap.object} {gap.technique} against {gap.truth}", classname=gap.case)
        test.result = [Error("the suite asks for this row and the run did not give it")]
        suite.add_testcase(test)
    if results.reasons:
        test = TestCase("verdict", classname=results.suite)
        test.result = [Failure("; ".join(results.reasons))]
        suite.add_testcase(test)
    xml = JUnitXml()
    xml.add_testsuite(suite)
    xml.update_statistics()
    write_text(path, xml.tostring().decode())


def _worse(results: Results) -> dict[Key, str]:
    """What is said of each row that got worse, where that fails the run."""
    if not results.changed or not results.changed.judged:
        return {}
    since = heading(results.changed)
    rows = by_row(results.changed).items()
    return {key: f"{worst(own)} {since}" for key, own in rows if verdict_of(own) == "worse"}


def markdown(results: Results, crops: Sequence[Crop] = ()) -> str:
    """The summary: verdict, reasons, pictures of the worst rows, and the worst rows."""
    heading = ", ".join([f"{results.suite} {headline(results).upper()}", *skips(results)])
    lines = [f"## shadeproof: {heading}", ""]
    if results.reasons:
        lines += [*(f"- {reason}" for reason in results.reasons), ""]
    for crop in crops:
        told = describe(crop.row).replace("[", "(").replace("]", ")")
        lines += [f"![{told}]({crop.path})", "", f"{told}; candidate, reference, signed error", ""]
    lines += [
        f"| {' | '.join(COLUMNS)} |",
        f"|{' --- |' * len(COLUMNS)}",
    ]
    shown = worst_first(results.rows)[:SHOWN]
    lines += [_line(row) for row in shown]
    counts = f"The worst {len(shown)} of {len(results.rows)} rows; {results.expected_rows} in all."
    lines += ["", f"{counts} Again: `{results.command}`", ""]
    if results.changed:
        lines += markdown_of_changes(results.changed)
    if results.beside:
        lines += [f"How far off, beside {results.beside.suite}:", "", f"| {' | '.join(BESIDE)} |"]
        lines += [f"|{' --- |' * len(BESIDE)}"]
        lines += [f"| {' | '.join(beside_cells(r))} |" for r in results.beside.ratios] + [""]
    return "\n".join(lines)


def _line(row: Row) -> str:
    problem = row.problem.replace("|", "\\|").replace("\n", " ")
    figures = (
        f"{problem} | | "
        if row.problem
        else f"{row.energy_local:.2%} | {row.energy_error:+.2%} | {row.ssim:.4f}"
    )
    return (
        f"| {row.verdict} | {row.case} | {row.object} | {row.material} | {row.weight:g} "
        f"| {row.technique} | {row.truth} | {figures} |"
    )


def annotate(results: Results, path: Path, crops: Sequence[Crop] = ()) -> None:
    """Write the summary to `path` and where GITHUB_STEP_SUMMARY says; print ::error lines in CI."""
    text = markdown(results, crops)
    write_text(path, text)
    if extra := os.environ.get("GITHUB_STEP_SUMMARY"):
        try:
            with Path(extra).open("a", encoding="utf-8") as summary:
                summary.write(text)
        except OSError as error:
            print(f"warning: GITHUB_STEP_SUMMARY: {error.strerror}: {extra}", file=sys.stderr)
    if os.environ.get("GITHUB_ACTIONS"):
        bad = ["fail"] if results.allow_inconclusive else ["fail", "inconclusive"]
        for row in worst_first(results.rows):
            if row.verdict in bad:
                _annotation(row.case, describe(row))
        for reason in results.reasons:
            _annotation(results.suite, reason)


def _annotation(title: str, text: str) -> None:
    """An ::error line, on standard error so that --json stays clean."""
    print(f"::error title=shadeproof {title}::{_escaped(text)}", file=sys.stderr)


def _escaped(text: str) -> str:
    """A workflow command's message is one line; GitHub's rules for %, CR and LF."""
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")
