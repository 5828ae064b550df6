"""Do the intervals hold? Figures from few batches of a stored pool against 16 times the samples."""

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from rich.console import Console
from rich.table import Column, Table
from scipy.ndimage import gaussian_filter
from skimage.restoration import denoise_nl_means

from reports import gate
from reports.display import exposure_for
from reports.metrics import energy, flip, relmse, ssim
from reports.metrics.subject import Subject, TruthView
from reports.results import Row
from scenes.suite import Budget

FEW, TRUTH, HELD = 8, 128, 32  # batches: to measure from, to hold against, to make candidates of
FAMILY = 800  # verdicts that must hold together: 140 rows of three figures, looked at twice
DISTANCES = (-10, -6, -3, -2, -1, -0.5, 0.5, 1, 2, 3, 6, 10)  # of budgets, in standard errors
FLIP_EVERY = 10  # resamplings; a call takes a third of a second
INTERVALS = {
    "ssim": "ssim_ci95",
    "ssim_p5": "ssim_p5_ci95",
    "ssim_highlights": "ssim_highlights_ci95",
    "energy_error": "energy_ci95",
    "energy_local": "energy_local_ci95",
    "relmse": "relmse_ci95",
    "relmse_median": "relmse_median_ci95",
    "flip": "flip_ci95",
}


@dataclass(frozen=True, eq=False)
class Pool:
    """Independent batches of one object: (n, h, w, 3) linear radiance, and its mask (h, w)."""

    name: str
    batches: np.ndarray
    mask: np.ndarray
    coarse: np.ndarray  # (8, h, w, 3), one sample per pixel each

    @property
    def exposure(self) -> float:
        """The display scale, from all batches."""
        return exposure_for(self.batches.mean(axis=0), self.mask)

    def view(self, batches: np.ndarray) -> TruthView:
        """Some batches as a truth."""
        return TruthView(batches, self.mask, self.exposure)


@dataclass(eq=False)
class Record:
    """What the resamplings said of one candidate in one pool, a list per figure."""

    pool: str
    candidate: str
    few: list[dict] = field(default_factory=list)
    many: list[dict] = field(default_factory=list)
    fourfold: list[dict] = field(default_factory=list)


def candidates(held: np.ndarray) -> dict[str, np.ndarray]:
    """Right and wrong pictures, (h, w, 3) each, of batches that nothing is measured from."""
    mean = held.mean(axis=0)
    ramp = np.linspace(0.8, 1.2, mean.shape[1])[None, :, None]
    shown = np.log1p(4 * np.clip(held[0], 0, None))  # a denoiser wants a bounded picture
    smooth = denoise_nl_means(
        shown, patch_size=5, patch_distance=6, h=0.08, channel_axis=2, fast_mode=True
    )
    made = {
        "right": mean,
        "blurred": gaussian_filter(mean, (1.5, 1.5, 0)),
        "5 % brighter": 1.05 * mean,
        "tilted ±20 %": ramp * mean,
        "hue-shifted": mean * np.array([1.08, 1, 0.92]),
        "denoised": np.expm1(smooth) / 4,  # non-local means of one batch
    }
    return {name: picture.astype(np.float32) for name, picture in made.items()}


def resample(pool: Pool, times: int, told: Callable[[], None] = lambda: None) -> list[Record]:
    """Draw 8 batches without replacement, with the other 128 as the truth, `times` over.

    Args:
        told: called at each drawing.

    Returns:
        One record per candidate.
    """
    rng = np.random.default_rng(0)
    used, held = pool.batches[: FEW + TRUTH], pool.batches[FEW + TRUTH :]
    pictures = candidates(held)
    records = [Record(pool.name, name) for name in pictures]
    for time in range(times):
        told()
        order = rng.permutation(len(used))
        few, many = pool.view(used[order[:FEW]]), pool.view(used[order[FEW:]])
        fourfold = pool.view(used[order[FEW : 5 * FEW]])
        for record, picture in zip(records, pictures.values(), strict=True):
            with_flip = time % FLIP_EVERY == 0
            record.few.append(_figures(Subject(picture, few), with_flip))
            record.many.append(_figures(Subject(picture, many), with_flip))
            if time % FLIP_EVERY == 0:
                record.fourfold.append(_figures(Subject(picture, fourfold), False))
    return records


def _figures(subject: Subject, with_flip: bool) -> dict:
    measured = {}
    for figures in (ssim.figures, energy.figures, relmse.figures):
        measured |= figures(subject)
    return measured | flip.figures(subject) if with_flip else measured


def coverage(record: Record, figure: str) -> tuple[float, float, float, float, float]:
    """How one figure fared.

    Returns:
        Its value at 16 times the samples, mean difference from it, largest difference, mean half
        width of the intervals, and the share of them that hold it.
    """
    pairs = [(f, m) for f, m in zip(record.few, record.many, strict=True) if figure in f]
    value = np.array([f[figure] for f, _ in pairs])
    truth = np.array([m[figure] for _, m in pairs])
    low, high = np.array([f[INTERVALS[figure]] for f, _ in pairs]).T
    off = value - truth
    held = (low <= truth) & (truth <= high)
    return (
        float(truth.mean()),
        float(off.mean()),
        float(np.abs(off).max()),
        float(np.nanmean(high - low) / 2) if np.isfinite(low).any() else math.nan,
        float(held.mean()),
    )


def verdicts(record: Record, figure: str) -> list[Counter]:
    """Verdicts of all resamplings, per budget placed close to the true value.

    Budgets lie DISTANCES standard errors from what all 16 times the samples say.
    """
    stem = gate.NOISY[figure]
    truth = float(np.mean([m[figure] for m in record.many]))
    low, high = np.mean([f[INTERVALS[figure]] for f in record.few], axis=0)
    se, counts = (high - low) / 2 / 1.96, []
    for distance in DISTANCES:
        limit = abs(truth) + distance * se
        if not 0 < limit < (1 if figure == "ssim" else math.inf):  # nor where it is unknown
            continue
        rule = Budget(technique="t", truth="global", **{figure: limit})
        said = Counter()
        for few in record.few:
            wanted = {k: v for k, v in few.items() if k == figure or k.startswith(f"{stem}_")}
            said[gate.judge(_row(wanted), [rule], FAMILY).verdict] += 1
        counts.append(said)
    return counts


def flips(record: Record, figure: str) -> int:
    """How many of the budgets near the truth are both passed and failed."""
    return sum("pass" in said and "fail" in said for said in verdicts(record, figure))


def unstable(pool: Pool) -> list[tuple[str, str, float, tuple[float, float], float]]:
    """Figures of the right candidate from 8 single samples per pixel.

    Returns:
        Per figure: pool, figure, value, interval, and what the whole pool says.
    """
    picture = candidates(pool.batches[FEW + TRUTH :])["right"]
    coarse, fine = (
        _figures(Subject(picture, pool.view(b)), False)
        for b in (pool.coarse, pool.batches[: FEW + TRUTH])
    )
    return [
        (pool.name, f, coarse[f], coarse[INTERVALS[f]], fine[f]) for f in INTERVALS if f in coarse
    ]


def _row(figures: dict) -> Row:
    names = dict.fromkeys(("case", "scene", "environment", "object", "material"), "")
    numbers = dict.fromkeys(("roughness", "metallic", "weight", "weight_g"), 0.0)
    return Row(**names, **numbers, technique="t", picture="t", truth="global", **figures)


def print_tables(records: list[Record], pools: list[Pool], console: Console) -> None:
    """The experiments of docs/noise.md, a table each."""
    for table in (
        _differences(records),
        _coverages(records),
        _changes(records),
        _verdict_table(records),
        _unstable_table(pools),
    ):
        console.print(table)


def _differences(records: list[Record]) -> Table:
    heads = "16x", "mean off", "largest off", "half width", "held by 95 %"
    table = _table(
        "8 batches against 16 times the samples", 3, "pool", "candidate", "figure", *heads
    )
    for record in records:
        for figure in INTERVALS:
            truth, *sizes, held = coverage(record, figure)
            table.add_row(
                record.pool, record.candidate, figure, f"{truth:.4f}",
                *(f"{size:.1e}" for size in sizes), f"{held:.0%}",
            )  # fmt: skip
    return table


def _coverages(records: list[Record]) -> Table:
    table = _table("coverage of 95 % intervals", 1, "figure", "cases", "least", "mean", "most")
    for figure in INTERVALS:
        held = [coverage(r, figure)[4] for r in records]
        shares = (f"{share:.0%}" for share in (min(held), np.mean(held), max(held)))
        table.add_row(figure, str(len(held)), *shares)
    return table


def _changes(records: list[Record]) -> Table:
    heads = "largest mean change", "in half widths"
    table = _table("the same answer at 1x and 4x the samples", 1, "figure", *heads)
    for figure in (f for f in INTERVALS if f != "flip"):
        found = [_change(r, figure) for r in records]
        table.add_row(figure, *(f"{max(c[k] for c in found):.2g}" for k in (0, 1)))
    return table


def _verdict_table(records: list[Record]) -> Table:
    names = "pass", "fail", "inconclusive"
    title = f"verdicts near their budgets, {FAMILY} at once at 1e-3"
    table = _table(title, 1, "figure", "budgets", "both passed and failed", *names)
    for figure in gate.NOISY:
        said = [v for r in records for v in verdicts(r, figure)]
        total, both = sum(said, Counter()), sum(flips(r, figure) for r in records)
        table.add_row(figure, str(len(said)), str(both), *(str(total[v]) for v in names))
    return table


def _unstable_table(pools: list[Pool]) -> Table:
    title = "8 batches of one sample per pixel; nan is `unknown`"
    table = _table(title, 2, "pool", "figure", "value", "low", "high", "16x")
    for pool in pools:
        for name, figure, value, (low, high), truth in unstable(pool):
            table.add_row(name, figure, *(f"{v:.3f}" for v in (value, low, high, truth)))
    return table


def _table(title: str, words: int, *heads: str) -> Table:
    """A table whose first columns hold words and whose others hold numbers."""
    columns = (
        Column(head, justify="left" if k < words else "right") for k, head in enumerate(heads)
    )
    return Table(*columns, title=title)


def _change(record: Record, figure: str) -> tuple[float, float]:
    """Mean change from 1x to 4x the samples, and as a share of the half width at 1x."""
    pairs = zip(record.few[::FLIP_EVERY], record.fourfold, strict=True)
    change = abs(float(np.mean([a[figure] - b[figure] for a, b in pairs])))
    return change, change / coverage(record, figure)[3]
