"""Verdicts: a row against its budget, and a run against its suite."""

import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from reports.change.ranking import NEW_ROW, by_row, verdict_of
from reports.noise import CONFIDENCE, Estimate, sidak
from reports.results import Changes, Missing, Results, Row, Verdict
from scenes.errors import InputError
from scenes.schema import PHYSICAL, Model
from scenes.suite import Budget, Entry, Sampling

UPPER, LOWER = ("energy_error", "energy_local"), ("ssim", "silhouette")
SELECTORS = ("scene", "environment", "object", "material", "weight", "technique", "truth")
# What the fields of a figure's noise begin with; `silhouette` has none.
NOISY = {"energy_error": "energy", "energy_local": "energy_local", "ssim": "ssim"}
FAMILY_ERROR = 1e-3  # chance that any verdict of a whole suite is wrong by the reference's noise
SHARP = 1 / 3  # of its budget: a 95 % interval wider than that cannot judge
FIRST_BATCHES = 8  # that a reference starts with; they double at every look

Drawn = Callable[[Entry, str, str], Model]  # by a technique against a truth of an entry


def budget_of(row: Row, rules: Sequence[Budget]) -> tuple[dict[str, float], list[str]]:
    """The limits that hold for a row, and the reasons of the overrides among them."""
    return _limits(row.model_dump(include={*SELECTORS}), rules)


def _limits(
    identity: dict[str, Any], rules: Sequence[Budget]
) -> tuple[dict[str, float], list[str]]:
    limits, reasons = {}, []
    for rule in rules:
        wanted = rule.selectors | {"technique": rule.technique, "truth": rule.truth}
        if any(identity[name] != value for name, value in wanted.items()):
            continue
        limits |= {m: v for m in (*UPPER, *LOWER) if (v := getattr(rule, m)) is not None}
        if rule.reason:
            reasons.append(rule.reason)
    return limits, reasons


def check_rules(
    rules: Sequence[Budget], entries: Sequence[Entry], drawn: Drawn, outside: str, path: Path
) -> None:
    """Refuse a rule that no row of the suite can meet: a typo would else switch it off.

    Raises:
        InputError: naming the rule.
    """
    rows = [
        (identity, judged)
        for entry in entries
        for identity, judged in _identities(entry, [*entry.techniques, outside], drawn)
    ]
    for number, rule in enumerate(rules):
        wanted = rule.selectors | {"technique": rule.technique, "truth": rule.truth}
        met = [judged for row, judged in rows if all(row[k] == v for k, v in wanted.items())]
        if met and not any(met):
            problem = f"`{rule.technique}` draws another model than `{rule.truth}`"
            remedy = "use `global` or `unoccluded`"
            if rule.truth == "physical":
                remedy += ", or model = 'physical' in a run"
            raise InputError(path, f"budget.{number}.truth", problem, remedy)
        if not met:
            shown = ", ".join(f"{k} = {v}" for k, v in wanted.items())
            raise InputError(
                path, f"budget.{number}", f"matches no row ({shown})", "mend or remove it"
            )


def judged_against(truth: str, model: Model) -> bool:
    """Whether a budget may hold a candidate that draws a model against a truth.

    `physical` draws the model PHYSICAL, whatever the case's, and `physical-smith` is only told.
    """
    return not truth.startswith("physical") or (truth == "physical" and model == PHYSICAL)


def budgeted(
    rules: Sequence[Budget], entry: Entry, techniques: Sequence[str], drawn: Drawn
) -> Iterator[tuple[str, str, str]]:
    """Object, technique and truth of an entry's rows that a rule judges."""
    for identity, judged in _identities(entry, techniques, drawn):
        if judged and _limits(identity, rules)[0]:
            yield identity["object"], identity["technique"], identity["truth"]


def family_size(
    rules: Sequence[Budget],
    entries: Sequence[Entry],
    sampling: Sampling,
    drawn: Drawn,
    labels: Callable[[Entry], Sequence[str]],
) -> int:
    """How many times a suite holds a noisy figure against its budget, at most.

    Every budgeted figure of every row counts once per look, since batches are added until all
    figures are decided.

    Args:
        entries: of the whole suite, so that a filter changes no verdict.
        drawn: the model of the picture that a technique sets against a truth of an entry.
        labels: the techniques that an entry's rows name.
    """
    doublings = math.log2(sampling.max_samples / sampling.samples_per_batch / FIRST_BATCHES)
    figures = sum(
        metric in NOISY
        for entry in entries
        for identity, judged in _identities(entry, labels(entry), drawn)
        for metric in (_limits(identity, rules)[0] if judged else ())
    )
    return max(figures, 1) * (1 + math.ceil(doublings))


def _identities(
    entry: Entry, techniques: Sequence[str], drawn: Drawn
) -> Iterator[tuple[dict[str, Any], bool]]:
    """What rules select rows by, for every row that an entry gives, and whether it is judged."""
    for obj in entry.case.judged:
        for technique in techniques:
            for truth in entry.truths:
                identity = {
                    "scene": entry.case.scene,
                    "environment": entry.case.environment.name,
                    "object": obj.name,
                    "material": obj.material.name,
                    "weight": obj.material.weight,
                    "technique": technique,
                    "truth": truth,
                }
                yield identity, judged_against(truth, drawn(entry, technique, truth))


def bounds(row: Row, metric: str, confidence: float) -> tuple[float, float]:
    """The interval of a judged figure at some confidence, from its standard error."""
    value = getattr(row, metric)
    if metric not in NOISY:
        return value, value
    stem = NOISY[metric]
    se, dof = getattr(row, f"{stem}_se"), getattr(row, f"{stem}_dof")
    if metric != "energy_local":
        return Estimate(value, se, dof).interval(confidence)
    low, high = Estimate(value**2, se, dof).interval(confidence)
    return (math.sqrt(max(low, 0)), math.sqrt(max(high, 0))) if low == low else (low, high)


def judge(row: Row, rules: Sequence[Budget], family: int = 1) -> Row:
    """The row with its budget, margins and verdict.

    A figure passes when its whole interval does and fails when none of it does; in between it is
    inconclusive, and `note` says how many samples would decide, unless another figure fails the
    row. The intervals are so wide that
    of `family` verdicts (`family_size`) any is wrong with a chance of 1e-3 (Šidák 1967). Margins
    are fractions of the budget, negative where the figure is over it.
    """
    limits, reasons = budget_of(row, rules)
    confidence = sidak(FAMILY_ERROR, family)
    margins, verdicts, unsharp, deciding = {}, {}, [], []
    notes = [*filter(None, [row.note]), *(f"budget: {r}" for r in dict.fromkeys(reasons))]
    for metric, limit in limits.items():
        value = getattr(row, metric)
        low, high = bounds(row, metric, confidence)
        verdicts[metric], margins[metric] = _verdict(metric, value, low, high, limit)
        if metric == "silhouette" and math.isnan(value):
            notes.append("silhouette: the candidate gives no object ids")
        if verdicts[metric] == "inconclusive":
            deciding.append(_samples_to_decide(row, metric, value, low, high, limit))
        elif not row.problem and not _sharp(row, metric, limit):
            notes.append(f"{metric}: its 95 % interval is wider than a third of its budget")
        if not row.problem and not _sharp(row, metric, limit):
            unsharp.append(metric)
    if row.problem:
        verdict = "fail"
    else:
        order = ("fail", "inconclusive", "pass")
        verdict = next((v for v in order if v in verdicts.values()), "reported")
    if verdict != "fail":
        notes += deciding
    return row.model_copy(
        update={
            "budget": limits,
            "margins": margins,
            "verdict": verdict,
            "confidence": confidence if limits else math.nan,
            "undecided": [m for m, v in verdicts.items() if v == "inconclusive"],
            "unsharp": unsharp,
            "note": "; ".join(notes),
        }
    )


def settled(row: Row) -> bool:
    """Whether no more batches are needed: every judged figure is decided, and sharp."""
    return bool(row.problem) or not (row.undecided or row.unsharp)


def _sharp(row: Row, metric: str, limit: float) -> bool:
    """Whether half the 95 % interval is at most a third of the budget (of SSIM's way to 1)."""
    low, high = bounds(row, metric, CONFIDENCE)
    if metric not in NOISY or math.isinf(getattr(row, metric)):
        return True
    allowed = 1 - limit if metric in LOWER else limit
    return (high - low) / 2 <= SHARP * allowed


def _verdict(
    metric: str, value: float, low: float, high: float, limit: float
) -> tuple[Verdict, float]:
    """One figure against its limit, with its margin."""
    if math.isnan(value):
        return "fail", float("nan")
    if metric in LOWER:
        margin = (value - limit) / max(1 - limit, 1e-9)
        passes, fails = low >= limit, high < limit  # both false for an interval of NaN
    else:
        margin = 1 - abs(value) / limit
        reach = max(abs(low), abs(high))
        passes, fails = reach <= limit, low > limit or high < -limit
    return ("pass" if passes else "fail" if fails else "inconclusive"), margin


def _samples_to_decide(
    row: Row, metric: str, value: float, low: float, high: float, limit: float
) -> str:
    """How many samples would part the interval from the budget; its width falls as 1/sqrt(n)."""
    distance = abs(abs(value) - limit)
    if math.isnan(low) or math.isnan(high):
        return f"{metric}: the reference's noise hides it"
    if distance == 0:
        return f"{metric} lies on its budget"
    factor = ((high - low) / 2 / distance) ** 2
    if not math.isfinite(factor):
        return f"{metric}: its interval has no end"
    samples = math.ceil(row.reference_spp * factor)
    if samples <= row.reference_spp:  # its interval is skew: the near side is the wide one
        return f"{metric}: its noise is uneven: at least twice the samples would decide"
    return f"{metric}: about {samples} samples per pixel would decide"


def conclude(results: Results) -> Results:
    """The verdict of a whole run, with every reason for which it fails."""
    reasons = []
    if not results.rows:
        reasons.append("no case was compared")
    if results.missing:
        first = results.missing[0]
        reasons.append(
            f"{len(results.missing)} of {results.expected_rows} rows are missing, first "
            f"{first.case} {first.object} ({first.technique} against {first.truth})"
        )
    failed = [r for r in results.rows if r.verdict == "fail"]
    undecided = [r for r in results.rows if r.verdict == "inconclusive"]
    if failed:
        reasons.append(f"{len(failed)} of {len(results.rows)} rows fail")
    if undecided and not results.allow_inconclusive:
        reasons.append(f"{len(undecided)} rows are inconclusive at the cap of samples")
    reasons += [
        f"conformance of {c['name']} fails: {c['detail']}"
        for c in results.provenance.get("parity", ())
        if c.get("judged") and not c["passed"]
    ]
    judged = any(r.verdict in ("pass", "fail", "inconclusive") for r in results.rows)
    if results.changed and results.changed.judged:
        reasons += list(_regressions(results.changed, results.skipped))
    elif results.rows and not judged:
        reasons.append("no row has a budget, so nothing was judged")
    return results.model_copy(update={"verdict": "fail" if reasons else "pass", "reasons": reasons})


def _regressions(changed: Changes, skipped: Sequence[str]) -> Iterator[str]:
    """Why a run fails beside an earlier one; a case that the filter skips is not missed."""
    rows = by_row(changed)
    worse = [key for key, own in rows.items() if verdict_of(own) == "worse"]
    if worse:
        case, thing, technique, truth = worse[0]
        yield (
            f"{len(worse)} of {len(rows)} rows are worse than in {changed.path}, first {case} "
            f"{thing} ({technique} against {truth})"
        )
    left_out = {name.split(" (filter")[0] for name in skipped}
    lost = [i for i in changed.incomparable if i.lost and i.case not in left_out]
    if lost:
        yield f"{len(lost)} rows of {changed.path} are gone, first {lost[0].case} {lost[0].object}"
    other = [i for i in changed.incomparable if not i.lost and i.reason != NEW_ROW]
    if other:
        first = f"{other[0].case} {other[0].object}: {other[0].reason}"
        yield f"{len(other)} rows could not be compared with {changed.path}, first {first}"
    if not rows:
        yield f"no row could be compared with {changed.path}"


def headline(results: Results) -> Verdict:
    """What a run has to say: its verdict, or `reported` where that nothing was judged is all."""
    judged = any(r.verdict != "reported" for r in results.rows)
    judged |= bool(results.changed and results.changed.judged)
    return results.verdict if judged or not results.rows or results.missing else "reported"


def worst_first(rows: list[Row]) -> list[Row]:
    """Rows by verdict (fail, inconclusive, pass, reported), then by their smallest margin."""
    order = {"fail": 0, "inconclusive": 1, "pass": 2, "reported": 3}

    def key(row: Row) -> tuple[int, int, float, float]:
        margins = [m for m in row.margins.values() if not math.isnan(m)]
        size = row.energy_local if not math.isnan(row.energy_local) else 0.0
        return order[row.verdict], 0 if row.problem else 1, min(margins, default=math.inf), -size

    return sorted(rows, key=key)


def missing_rows(expected: list[Missing], rows: list[Row]) -> list[Missing]:
    """Those of the expected rows that are not there."""
    there = {r.key for r in rows}
    return [m for m in expected if m.key not in there]
