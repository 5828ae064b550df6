"""Changes by row, and rows by how much worse they got."""

import math
from collections.abc import Iterable

from reports.results import Change, Changes, Key

NEW_ROW = "the old run does not have it"  # why there is no change, and no harm in that
ORDER = ("worse", "better", "unclear", "unchanged")
RISES = {"ssim": -1}  # figures that fall where a picture gets worse


def verdict_of(changes: Iterable[Change]) -> str:
    """Of one row's changes the first of ORDER that any figure has."""
    verdicts = {c.verdict for c in changes}
    return next((v for v in ORDER if v in verdicts), "unchanged")


def by_row(changes: Changes) -> dict[Key, list[Change]]:
    """The changes of each row, the most worse first."""
    rows: dict[Key, list[Change]] = {}
    for change in changes.changes:
        rows.setdefault(change.key, []).append(change)

    def rank(own: list[Change]) -> tuple[int, float]:
        return ORDER.index(verdict_of(own)), -max(abs(harm(c)) for c in own)

    return dict(sorted(rows.items(), key=lambda item: rank(item[1])))


def harm(change: Change) -> float:
    """By how many tolerances a figure got worse; negative where it got better."""
    if not math.isfinite(change.change):
        return 0.0
    return RISES.get(change.figure, 1) * change.change / change.tolerance
