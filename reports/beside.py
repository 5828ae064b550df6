"""How far off one run is beside another: cases never seen beside those of the shipped suite."""

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from statistics import median

from reports.results import Beside, Missing, Ratio, Results, Row, load_results
from scenes.errors import InputError

ERRORS = {
    "energy_error": lambda row: abs(row.energy_error),
    "energy_local": lambda row: row.energy_local,
    "1 - ssim": lambda row: 1 - row.ssim,
}


def load_other(path: Path, expected: Iterable[Missing]) -> Results:
    """Read the results of another run, to stand beside one that will give the expected rows.

    Raises:
        InputError: they cannot be read, or share no technique and truth with it.
    """
    other = load_results(path)
    pairs = {(r.technique, r.truth) for r in other.rows}
    if not pairs & {(e.technique, e.truth) for e in expected}:
        known = ", ".join(f"{technique} against {truth}" for technique, truth in sorted(pairs))
        problem = f"shares no technique and truth with this run: it has {known or 'no rows'}"
        raise InputError("--beside", str(path), problem, "give results of the same techniques")
    return other


def beside(results: Results, other: Results, path: Path) -> Results:
    """The results with their errors as multiples of another run's.

    Each figure of ERRORS gives, for every technique and truth that both have, a ratio of medians
    over rows and one of the worst rows. Rows without figures are left out: they fail anyway.
    """
    pairs = dict.fromkeys((r.technique, r.truth) for r in results.rows)
    ratios = []
    for pair in pairs:
        ours, theirs = (
            [r for r in x.rows if (r.technique, r.truth) == pair] for x in (results, other)
        )
        if theirs:
            ratios += [_ratio(*pair, figure, ours, theirs) for figure in ERRORS]
    told = Beside(suite=other.suite, path=str(path), ratios=ratios)
    return results.model_copy(update={"beside": told})


def _ratio(
    technique: str, truth: str, figure: str, ours: Sequence[Row], theirs: Sequence[Row]
) -> Ratio:
    errors, others = (
        [e for r in x if math.isfinite(e := ERRORS[figure](r))] for x in (ours, theirs)
    )
    (middle, worst), (their_middle, their_worst) = (
        (median(e), max(e)) if e else (math.nan, math.nan) for e in (errors, others)
    )
    return Ratio(
        technique=technique,
        truth=truth,
        figure=figure,
        rows=len(errors),
        other_rows=len(others),
        median=middle,
        other_median=their_middle,
        median_ratio=_over(middle, their_middle),
        worst=worst,
        other_worst=their_worst,
        worst_ratio=_over(worst, their_worst),
    )


def _over(ours: float, theirs: float) -> float:
    """Of an error that noise hides (taken out, it may be 0 or less) there is no multiple."""
    return ours / theirs if theirs > 0 else math.nan
