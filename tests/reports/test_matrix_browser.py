"""The report's matrix in a real browser, on a narrow screen: no number leaves its cell."""

import pytest

from reports.html import write_report
from tests.reports import browser
from tests.reports.pages import results, row

CHECKS = """
const cells = [...document.querySelectorAll(".matrix td a")].filter((a) => a.offsetParent);
out.cells = cells.length;
out.broken = cells.flatMap((a) => [...a.querySelectorAll("b, small")]).filter((e) => {
  const range = document.createRange(); range.selectNodeContents(e);
  return new Set([...range.getClientRects()].map((r) => r.top)).size > 1; }).length;
out.spilt = cells.filter((a) => a.scrollWidth > a.clientWidth).length;
out.wide = document.documentElement.scrollWidth > innerWidth;
"""
FIGURES = {
    "energy_local": 0.1234, "energy_local_ci95": (0.1232, 0.1236), "energy_error": -0.1034,
    "energy_ci95": (-0.1036, -0.1032),
}  # fmt: skip


@pytest.mark.parametrize("crossed", [True, False])
def test_no_number_breaks_or_leaves_its_cell(tmp_path, crossed):
    weights = [0, 0.1, 0.2, 0.25, 0.5, 0.6, 0.7, 0.75, 1]
    rows = [
        row(object=f"m{i}", material="copper" if crossed else f"m{i}", weight=w, **FIGURES)
        for i, w in enumerate(weights)
    ]
    seen = browser.seen(write_report(results(rows), tmp_path), CHECKS)
    assert seen == {"cells": 2 * len(weights), "broken": 0, "spilt": 0, "wide": False}
