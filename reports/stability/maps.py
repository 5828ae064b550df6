"""From figures over a grid to a map with its worst point and the command that reproduces it."""

import shlex
from collections.abc import Callable

import numpy as np

from reports.stability.agreement import off_by
from reports.stability.results import Axis, Map, Worst

SCALE = "|difference| over max(|f|, 1e-4 of the largest in the cell)"

Shown = dict[str, object]  # inputs by name, as a command takes them


def difference(
    ours: np.ndarray,
    exact: np.ndarray,
    cells: tuple[int, ...],
    peak: np.ndarray | float | None = None,
) -> np.ndarray:
    """|ours - exact| over max(|exact|, 1e-4 of the peak), the worst of all parts, (*cells, k).

    What is no number counts as infinite.

    Args:
        ours, exact: (n, parts), n rows over cells of k rows each.
        peak: of the lobe, (n,) or one; by default the largest |exact| in a cell.
    """
    shape = (*cells, -1, exact.shape[-1])
    ours, exact = ours.reshape(shape), exact.reshape(shape)
    if peak is None:
        peak = np.abs(exact).max(axis=-2, keepdims=True)
    elif np.ndim(peak):
        peak = np.reshape(peak, (*shape[:-1], 1))
    return off_by(ours, exact, peak).max(axis=-1)


def make_map(
    function: str,
    invariant: str,
    figures: np.ndarray,
    axes: tuple[Axis, Axis, Axis],
    reproduce: Callable[[tuple[int, int, int, int]], list[Shown]],
    *,
    why: str,
    unit: str,
    name: str = "",
    centre: float | None = None,
    tried: np.ndarray | None = None,
    masking: str = "",
    limit: float | None = None,
    at_least: float | None = None,
    judged: dict[str, tuple[float, float]] | None = None,
) -> Map:
    """A map of the worst figure in each cell.

    Args:
        figures: slices x rows x columns x k: of k inputs tried in each cell.
        name: what `--at` calls the function, where that is not `function`.
        centre: what is right, from which the worst is furthest; by default 0, or the middle of the
            allowed range.
        tried: rows x columns, the cells in which figures say anything; by default all.
    """
    if centre is None:
        centre = 0.0 if at_least is None else (at_least + limit) / 2
    badness = np.where(np.isnan(figures), np.inf, np.abs(figures - centre))
    at = badness.argmax(axis=-1)
    values = np.take_along_axis(figures, at[..., None], axis=-1)[..., 0]
    known = np.ones(values.shape, bool) if tried is None else np.broadcast_to(tried, values.shape)
    inside = known.copy()
    for dimension, axis in enumerate(axes):
        if bounds := (judged or {}).get(axis.name):
            found = np.asarray(axis.values)
            kept = (found >= bounds[0] * (1 - 1e-6)) & (found <= bounds[1] * (1 + 1e-6))
            inside &= np.expand_dims(kept, [d for d in range(3) if d != dimension])

    def worst(part: np.ndarray) -> Worst | None:
        if not part.any():
            return None
        bad = np.where(part, badness.max(axis=-1), -1)
        cell = np.unravel_index(bad.argmax(), bad.shape)
        return _worst(
            name or function, float(values[cell]), reproduce((*map(int, cell), int(at[cell])))
        )

    found, passed = worst(inside), True
    if limit is not None:
        low = -np.inf if at_least is None else at_least
        passed = bool(((values[inside] >= low) & (values[inside] <= limit)).all())
    return Map(
        function=function,
        invariant=invariant,
        masking=masking,
        why=why,
        unit=unit,
        axes=axes,
        values=_rounded(np.where(known, values, None)).tolist(),
        limit=limit,
        at_least=at_least,
        judged=judged or {},
        worst=found,
        beyond=worst(known & ~inside),
        passed=passed,
    )


def _rounded(values: np.ndarray) -> np.ndarray:
    """To three digits, near 1 of the departure from it; the worst point keeps all of its own."""

    def rounded(x: float | None) -> float | None:
        if x is None or not 0 < abs(x - 1) < 0.1:
            return x if x is None else float(f"{x:.3g}")
        return 1 + float(f"{x - 1:.3g}")

    return np.vectorize(rounded, otypes=[object])(values)


def _worst(function: str, value: float, evaluations: list[Shown]) -> Worst:
    """The worst point; its inputs are those of the first evaluation."""
    told = [{k: as_text(v) for k, v in inputs.items()} for inputs in evaluations]
    return Worst(value=value, inputs=told[0], command=command(function, *told))


def command(function: str, *evaluations: dict[str, str]) -> str:
    """What reproduces evaluations of a function at inputs given as text."""
    points = (" ".join([function, *(f"{k}={v}" for k, v in e.items())]) for e in evaluations)
    return " ".join(["shadeproof stability", *(f"--at {shlex.quote(p)}" for p in points)])


def as_text(value: object) -> str:
    """An input as a command takes it: numbers with all digits of a float32, parted by commas."""
    if isinstance(value, str):
        return value
    return ",".join(f"{float(x):.9g}" for x in np.atleast_1d(value))
