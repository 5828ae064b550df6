"""What CI reads: JUnit XML, a Markdown summary, and error annotations."""

import os
from pathlib import Path

from junitparser import Error, Failure, JUnitXml, Skipped, TestCase, TestSuite

from reports.gate import worst_first
from reports.results import Results, Row
from reports.terminal import describe
from scenes.frame import write_text

COLUMNS = (
    *("verdict", "case", "object", "material", "GGX share", "technique", "truth"),
    *("local energy", "energy", "SSIM"),
)


def write_junit(results: Results, path: Path) -> None:
    """JUnit XML: one test per row; missing rows and the run's own reasons are failures too."""
    suite = TestSuite(f"shadeproof.{results.suite}")
    for row in results.rows:
        test = TestCase(f"{row.object} {row.technique} against {row.truth}", classname=row.case)
        test.time = 0.0 if row.frame_ms != row.frame_ms else row.frame_ms / 1e3
        if row.verdict == "fail" or (
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


def markdown(results: Results) -> str:
    """The summary: verdict, reasons and the worst rows."""
    lines = [f"## shadeproof: {results.suite} {results.verdict.upper()}", ""]
    lines += [f"- {reason}" for reason in results.reasons]
    lines += [
        "",
        f"| {' | '.join(COLUMNS)} |",
        f"|{' --- |' * len(COLUMNS)}",
    ]
    lines += [_line(row) for row in worst_first(results.rows)[:20]]
    lines += [
        "",
        f"{len(results.rows)} of {results.expected_rows} rows. Again: `{results.command}`",
        "",
    ]
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


def annotate(results: Results, path: Path) -> None:
    """Write the summary to `path` and where GITHUB_STEP_SUMMARY says; print ::error lines in CI."""
    text = markdown(results)
    write_text(path, text)
    if extra := os.environ.get("GITHUB_STEP_SUMMARY"):
        with Path(extra).open("a", encoding="utf-8") as summary:
            summary.write(text)
    if os.environ.get("GITHUB_ACTIONS"):
        for row in worst_first(results.rows):
            if row.verdict == "fail":
                print(f"::error title=shadeproof {row.case}::{_escaped(describe(row))}")
        for reason in results.reasons:
            print(f"::error title=shadeproof {results.suite}::{_escaped(reason)}")


def _escaped(text: str) -> str:
    """A workflow command's message is one line; GitHub's rules for %, CR and LF."""
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")
