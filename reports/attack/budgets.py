"""Budgets for a suite that guards what is there: a line for each row of a run, just above it.

    python -m reports.attack.budgets RESULTS.json ...

prints the `budget` of scenes/suites/guard.toml from runs of it. One would do, but figures of a
technique that samples depend on the random turns of its directions, and figures at an edge on where
a driver puts its coverage samples: several runs tell by how much, each with other constants in
`pixel_shift` of shade_sampled.glsl, and one with 2x2 pixels a pixel.
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


def rule(rows: list[Row], by_weight: bool, confidence: float) -> str:
    """One rule, as an inline table; cases that share scene and environment differ in weight.

    Args:
        rows: the same row of each run.
        confidence: of the intervals that are wholly within it.
    """
    limits = {m: _above([_reach(r, m, confidence) for r in rows]) for m in FIGURES}
    limits["ssim"] = round(1 - limits["ssim"], 4)
    row = rows[0]
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


def _reach(row: Row, metric: str, confidence: float) -> float:
    """How far off the row may be by a reference of other batches, with an interval of its own."""
    if metric == "ssim":
        value, far = 1 - row.ssim, 1 - bounds(row, metric, confidence)[0]
    else:
        value, far = abs(getattr(row, metric)), max(map(abs, bounds(row, metric, confidence)))
    return value + 2 * (far - value)


def _above(errors: list[float]) -> float:
    """The largest, and the range of all of them on top: of five runs that is 3.5 deviations."""
    reach = 2 * max(errors) - min(errors)
    return round((1 + SLACK) * reach + DRIVER, 4)


def main(*paths: str) -> None:
    """Print the rules of every row of the runs, those that are told apart by weight last."""
    runs = zip(*(load_results(Path(p)).rows for p in paths), strict=True)
    together = [list(rows) for rows in runs]
    confidence = sidak(FAMILY_ERROR, len(FIGURES) * len(together))
    first = {(r.environment, r.object): r.case for r, *_ in reversed(together)}
    print("budget = [")
    for later in (False, True):
        for rows in together:
            if (rows[0].case != first[rows[0].environment, rows[0].object]) == later:
                print(f"    {rule(rows, later, confidence)},")
    print("]")


if __name__ == "__main__":
    main(*sys.argv[1:])
