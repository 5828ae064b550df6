"""Budgets for a suite that guards what is there: a line for each row of a run, just above it.

    python -m reports.attack.budgets reports/out/results.json

prints the `budget` of scenes/suites/guard.toml from a run of `shadeproof compare --suite guard`.
"""

import sys
from pathlib import Path

from reports.gate import FAMILY_ERROR, bounds
from reports.noise import sidak
from reports.results import Row, load_results

DRIVER = 0.002  # what another GPU or driver may round otherwise, of any figure
SLACK = 0.05  # of an error, on top
ERRORS = ("energy_error", "energy_local")
FIGURES = (*ERRORS, "ssim")


def rule(row: Row, by_weight: bool, confidence: float) -> str:
    """One rule, as an inline table; cases that share scene and environment differ in weight.

    Args:
        confidence: of the intervals that are wholly within it.
    """
    limits = {m: _above(max(map(abs, bounds(row, m, confidence)))) for m in ERRORS}
    limits["ssim"] = round(1 - _above(1 - bounds(row, "ssim", confidence)[0]), 4)
    fields = {
        "technique": row.technique,
        "truth": row.truth,
        "environment": row.environment,
        "object": row.object,
        **({"weight": row.weight} if by_weight else {}),
        **limits,
        "reason": "reached",
    }
    shown = (f'{k} = "{v}"' if isinstance(v, str) else f"{k} = {v:g}" for k, v in fields.items())
    return f"{{ {', '.join(shown)} }}"


def _above(error: float) -> float:
    return round((1 + SLACK) * error + DRIVER, 4)


def main(path: str) -> None:
    """Print the rules of every row of a results.json, those that are told apart by weight last."""
    rows = load_results(Path(path)).rows
    confidence = sidak(FAMILY_ERROR, len(FIGURES) * len(rows))
    first = {(r.environment, r.object): r.case for r in reversed(rows)}
    print("budget = [")
    for later in (False, True):
        for row in rows:
            if (row.case != first[row.environment, row.object]) == later:
                print(f"    {rule(row, later, confidence)},")
    print("]")


if __name__ == "__main__":
    main(*sys.argv[1:])
