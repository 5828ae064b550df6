"""Does a stored reference still hold? Its batches against fresh ones, path-traced here and now.

Two sets of independent batches of one picture have the same mean everywhere. That is tested per
truth, object and channel, over the whole object (where a small bias shows) and over its blocks of
16x16 pixels (where a local one does), by Welch's (1947) t: pixels are independent, so the variance
of a sum is the sum of the pixels' variances, each from the spread between batches. Half of the
family's error is given to the objects, half to the blocks, and divided among them (Bonferroni).

What has no noise must be equal bit for bit: the object that each pixel sees, which pixels are
traced, and the light of those that are not.
"""

from collections.abc import Callable, Iterable
from concurrent.futures import Executor, as_completed
from dataclasses import dataclass

import numpy as np
from scipy import stats

from reference.batches import Task, trace_batch
from reference.executor import Serial, explained
from reference.settings import FEWEST_BATCHES, Kind
from reference.store import Store
from scenes.frame import Frame
from scenes.schema import Case
from scenes.suite import Sampling

FAMILY_ERROR = 1e-3  # the chance that a sound store is refused
BLOCK = 16  # pixels
FRESH = 1_000_000  # numbers of fresh batches start here, where no stored one comes
ROUNDING = 1e-6  # of a mean: what another processor may round differently
STILL = 1e-5  # of a pixel that is not traced, for the same reason
TIES = 2e-4  # share of pixels (two at least) in which rays that graze an edge may fall otherwise
ONE_SIDED_95 = 1.645


@dataclass(frozen=True, eq=False)
class Regions:
    """Old against new over some regions of one picture, (n,) each; radiance summed over pixels.

    Attributes:
        difference: new less old.
        se, dof: its standard error, and Welch and Satterthwaite's degrees of freedom.
        total: of the old, what a percentage refers to.
        names: where each region is.
    """

    difference: np.ndarray
    se: np.ndarray
    dof: np.ndarray
    total: np.ndarray
    names: list[str]

    @property
    def sigma(self) -> np.ndarray:
        """Differences in standard errors, signed."""
        return self.difference / self.se

    @property
    def p(self) -> np.ndarray:
        """Two-sided probability of a difference as large, where old and new agree."""
        return 2 * stats.t.sf(np.abs(self.sigma), self.dof)


@dataclass(frozen=True)
class Check:
    """What became of one reference.

    Attributes:
        old, new: batches compared.
        sigma, relative: the least likely difference, in standard errors and as a fraction; NaN
            where something without noise is not equal.
        where: the truth, object, channel and perhaps block that it is in, or what is not equal.
        agrees: whether that could be chance, in this family of tests.
        visible: the smallest bias of an object's channel that would be seen with 95 % probability
            wherever it were, as a fraction.
    """

    case: str
    kind: Kind
    old: int
    new: int
    sigma: float
    relative: float
    where: str
    agrees: bool
    visible: float


def verify(
    wanted: Iterable[tuple[Case, Kind, Sampling]],
    store: Store,
    batches: int = 8,
    executor: Executor | None = None,
    progress: Callable[[str], None] | None = None,
) -> list[Check]:
    """Hold stored references against `batches` fresh batches each; those not stored are left out.

    Raises:
        InputError: as `reference.batches.grow`.
    """
    found = []
    for case, kind, sampling in wanted:
        old = store.load(case, kind, sampling)
        if len(old) < FEWEST_BATCHES:
            continue
        if progress:
            progress(f"{case.id}: {kind}")
        fresh = _fresh(case, kind, sampling, batches, executor or Serial())
        new = [frame for frame, _ in fresh]
        unequal = _unequal(old, store.backgrounds(case, kind, sampling), fresh)
        found.append((case.id, kind, len(old), len(new), *compare(case, old, new), unequal))
    tests = [sum(len(f[place].p) for f in found) for place in (4, 5)]
    return [_check(*f[:-1], *tests, f[-1]) for f in found]


def _fresh(
    case: Case, kind: Kind, sampling: Sampling, count: int, executor: Executor
) -> list[tuple[Frame, np.ndarray]]:
    tasks = [Task(case, kind, sampling, FRESH + n) for n in range(count)]
    futures = [executor.submit(trace_batch, task, task.identity) for task in tasks]
    try:
        return [future.result() for future in as_completed(futures)]
    except Exception as error:
        raise explained(error) from error


def _unequal(
    old: list[Frame], backgrounds: list[Frame], fresh: list[tuple[Frame, np.ndarray]]
) -> str:
    """What differs of that which has no noise by more than another processor's rounding, or "".

    Args:
        backgrounds: stored; their ids are 1 where pixels are traced.
        fresh: batches, and where they were traced.
    """
    batch, traced = fresh[0]
    frames = old + [frame for frame, _ in fresh]
    lit = np.any([traced, *(b.ids > 0 for b in backgrounds)], axis=0)
    differs = {
        "ids": [f.ids != batch.ids for f in frames],
        "traced pixels": [b.ids.astype(bool) != traced for b in backgrounds],
        "background": [
            ((np.abs(picture - batch.rgb) > STILL * np.abs(batch.rgb)) & ~lit[..., None]).any(
                axis=2
            )
            for picture in [f.rgb for f in frames] + [b.rgb for b in backgrounds]
        ],
    }
    counts = {name: int(np.any(masks, axis=0).sum()) for name, masks in differs.items()}
    allowed = dict.fromkeys(counts, max(2, round(TIES * batch.ids.size))) | {"background": 0}
    return ", ".join(
        f"{name} in {count} pixel{'s' * (count > 1)}"
        for name, count in counts.items()
        if count > allowed[name]
    )


def compare(case: Case, old: list[Frame], new: list[Frame]) -> tuple[Regions, Regions]:
    """The differences over whole objects, and over their blocks; regions without light are left.

    Args:
        old, new: at least two batches each.
    """
    ids = old[0].ids
    objects, blocks = [], []
    names = ["", *sorted({n for f in old + new for n in f.layers})]
    for name in names:
        pictures = [np.stack([_picture(f, name) for f in side]) for side in (old, new)]
        for obj in case.objects:
            mask = ids == case.index(obj.name)
            if not mask.any():
                continue
            place = f"{name or 'picture'}, {obj.name}"
            a, b = (p[:, mask].astype(np.float64) for p in pictures)
            y, x = np.nonzero(mask)
            across = -(-ids.shape[1] // BLOCK)
            block, label = np.unique((y // BLOCK) * across + x // BLOCK, return_inverse=True)
            spots = [f", block {n % across * BLOCK},{n // across * BLOCK}" for n in block]
            objects.append(_regions(a, b, np.zeros_like(label), [""], place))
            blocks.append(_regions(a, b, label, spots, place))
    return _joined(objects), _joined(blocks)


def _picture(frame: Frame, name: str) -> np.ndarray:
    """The picture or a layer; a layer that is black is not stored."""
    return frame.layers.get(name, np.zeros_like(frame.rgb)) if name else frame.rgb


def _regions(a: np.ndarray, b: np.ndarray, label: np.ndarray, spots: list, place: str) -> Regions:
    """Old a (n, pixels, 3) against new b (m, pixels, 3), pixels grouped by `label`."""

    def sums(values: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(label, values[:, c], len(spots)) for c in range(3)]).ravel()

    parts = [side.var(axis=0, ddof=1) / len(side) for side in (a, b)]
    total = sums(a.mean(axis=0))
    difference = sums(b.mean(axis=0)) - total
    variance = sums(parts[0]) + sums(parts[1])
    fourth = sums(parts[0] ** 2) / (len(a) - 1) + sums(parts[1] ** 2) / (len(b) - 1)
    rounding = ROUNDING * np.abs(total)
    se = np.sqrt(variance + rounding**2)
    with np.errstate(invalid="ignore", divide="ignore"):
        dof = np.where(fourth > 0, variance**2 / fourth, np.inf)
    names = [f"{place} {channel}{spot}" for channel in "RGB" for spot in spots]
    lit = (se > 0) | (difference != 0)
    kept = [n for n, keep in zip(names, lit, strict=True) if keep]
    return Regions(difference[lit], np.maximum(se, 1e-300)[lit], dof[lit], total[lit], kept)


def _joined(parts: list[Regions]) -> Regions:
    columns = ("difference", "se", "dof", "total")
    arrays = [np.concatenate([getattr(p, c) for p in parts]) for c in columns]
    return Regions(*arrays, [n for p in parts for n in p.names])


def _check(
    case: str,
    kind: Kind,
    old: int,
    new: int,
    objects: Regions,
    blocks: Regions,
    all_objects: int,
    all_blocks: int,
    unequal: str = "",
) -> Check:
    """Judge one reference as a member of a family of so many tests; see `_unequal`."""
    worst: tuple[float, Regions, int] | None = None
    for regions, count in ((objects, all_objects), (blocks, all_blocks)):
        index = int(np.argmin(regions.p))
        adjusted = float(regions.p[index]) * count / (FAMILY_ERROR / 2)
        if worst is None or adjusted < worst[0]:
            worst = adjusted, regions, index
    adjusted, regions, index = worst
    reach = stats.t.isf(FAMILY_ERROR / 4 / all_objects, objects.dof) + ONE_SIDED_95
    relative = regions.difference[index] / (abs(regions.total[index]) or np.nan)
    whole = np.array([".diffuse" not in name for name in objects.names])
    bias = reach * objects.se / np.maximum(np.abs(objects.total), 1e-300)
    return Check(
        case=case,
        kind=kind,
        old=old,
        new=new,
        sigma=np.nan if unequal else float(regions.sigma[index]),
        relative=np.nan if unequal else float(relative),
        where=unequal or regions.names[index],
        agrees=adjusted > 1 and not unequal,
        visible=float(bias[whole].max()),
    )
