"""What the points say, in plain sentences."""

import math
from collections.abc import Sequence

from markupsafe import Markup

from reports.html.figures import digits, number, percent, seconds, size
from reports.html.speed.scatter import FAMILIES, Quantity, error_of
from reports.results import Figured
from reports.speed.points import Bench, EqualError, Family, Growth, Point

# "60 frames per second at a resolution of 1920 x 1080 on my laptop using an integrated Intel Iris
# Plus 640 GPU": Cole, section IV.B.
PAPER_SECONDS, PAPER_SIZE = 1 / 60, (1920, 1080)
SIZE = "×".join(map(str, PAPER_SIZE))
NEEDS: dict[Family, str] = {"path traced": "Mitsuba", "denoised": "Mitsuba with a denoiser"}
COSTS = {"frame": "frame time", "precomputation": "precomputation", "memory": "memory"}


def headline(bench: Bench) -> str:
    """What the run says of the paper's frame rate, or else what it holds."""
    device = device_of(bench)
    full = _at_paper_size(bench)
    if not full:
        cases = len({p.case for p in bench.points})
        return f"Speed against error in {cases} case{'s' * (cases != 1)} on {device}"
    reach = _reaching(full)
    if reach:
        verb = "reaches" if len(reach) == 1 else "reach"
        return f"{', '.join(reach)} {verb} 60 frames per second at {SIZE} on {device}"
    best = min(full, key=lambda p: p.frame.median)
    return (
        f"No technique reaches 60 frames per second at {SIZE} on {device}: "
        f"the fastest, {best.name}, takes {seconds(best.frame.median)} a frame"
    )


def paper_rate(bench: Bench) -> str:
    """The paper's frame rate beside ours; empty where its size was not drawn."""
    full = sorted(_at_paper_size(bench), key=lambda p: p.frame.median)
    if not full:
        return ""
    rates = ", ".join(f"{p.name} {digits(1 / p.frame.median)}" for p in full[:6])
    reach = ", ".join(_reaching(full)) or "no technique"
    return (
        f"The paper tells of 60 frames per second ({seconds(PAPER_SECONDS)} a frame) at {SIZE} on "
        f"an Intel Iris Plus 640. On {device_of(bench)}, {reach} does so in three of four frames. "
        f"Frames per second at that size: {rates}."
    )


def device_of(bench: Bench) -> str:
    """What drew."""
    return str(bench.provenance.get("device", "a device that the run does not name"))


def verdict_of(point: Point, object_name: str, quantity: Quantity, bench: Bench) -> str:
    """One technique's time and error, and what path tracing needs to be as good."""
    error = quantity.of(error_of(point, object_name))
    frame = f"{seconds(point.frame.median)} a warm frame"  # whatever the switch shows
    said = f"{frame}, {quantity.inline} {quantity.show(error.value)}."
    found = {
        e.against: e for e in bench.equal
        if (e.case, e.object, e.technique, e.figure)
        == (point.case, object_name, point.name, quantity.field)
    }  # fmt: skip
    needs = [_need(found[f], point, bench) for f in FAMILIES if f in found]
    if not needs:
        return said
    whole = "; ".join(needs)
    return f"{said} {whole[0].upper()}{whole[1:]}."


def _need(equal: EqualError, point: Point, bench: Bench) -> str:
    """What one path tracer needs to be as good as a technique."""
    who = NEEDS.get(equal.against, equal.against)
    if equal.beyond == "below":
        return f"{who} is better at once{_fewest(equal, point, bench)}"
    if not math.isfinite(equal.samples.value):
        if equal.beyond == "above":
            return f"{who} does not get as good with the samples that were measured"
        return f"noise hides how many samples {who} would need"
    count = digits(equal.samples.value)
    plural = "" if count == "1" else "s"
    more = ", more than were measured," if equal.beyond == "above" else ""
    needs = f"{who} needs {count} sample{plural}{_ends(equal.samples)}{more} to be as good"
    return needs + _time(equal.seconds, equal.ratio)


def _fewest(equal: EqualError, point: Point, bench: Bench) -> str:
    """The fewest samples of a path tracer, and what they take beside a technique's frame."""
    own = [p for p in bench.points if (p.case, p.family) == (point.case, equal.against)]
    if not own:
        return ""
    least = min(own, key=lambda p: p.samples)
    ratio = least.frame.median / point.frame.median if point.frame.median else math.nan
    plural = "s" * (least.samples != 1)
    alone = (Figured(value=v, low=math.nan, high=math.nan) for v in (least.frame.median, ratio))
    return f", with {least.samples} sample{plural}{_time(*alone)}"


def _time(took: Figured, ratio: Figured) -> str:
    """Seconds, beside the technique's frame; empty where they are unknown."""
    if not math.isfinite(took.value):
        return ""
    said = f": {seconds(took.value)}"
    if not math.isfinite(ratio.value):
        return said
    if ratio.value >= 1:
        return f"{said}, {digits(ratio.value)} times as long{_ends(ratio)}"
    share = Figured(value=100 * ratio.value, low=100 * ratio.low, high=100 * ratio.high)
    return f"{said}, {percent(ratio.value)} of the time{_ends(share)}"


def _ends(figure: Figured) -> str:
    """An interval in brackets; nothing where it is unknown or too narrow to tell."""
    low, high = digits(figure.low), digits(figure.high)
    if not math.isfinite(figure.low) or low == high:
        return ""
    return f" ({low} to {high})" if math.isfinite(figure.high) else f" ({low} or more)"


def growth(found: Growth) -> Markup:
    """How one cost grows, as HTML: 'paper: frame time grows as pixels to 0.86 (0.83 to 0.90)'."""
    power, named = found.exponent, (found.technique, COSTS[found.cost], sizes_of(found))
    if not math.isfinite(power.value):
        return Markup("<b>{}</b>: noise hides how {} grows with {}").format(*named)
    ends = ""
    if math.isfinite(power.low) and math.isfinite(power.high):
        ends = f" ({number(power.low, 2)} to {number(power.high, 2)}"
        lopsided = power.high - power.value > 2 * (power.value - power.low)
        ends += ", with any base that noise hides)" if lopsided and not found.base else ")"
        if power.low <= 0 and not found.base:
            said = Markup("<b>{}</b>: {} is not seen to grow with {}: exponent {}").format(
                *named, number(power.value, 2)
            )
            return said + ends
    show = size if found.cost == "memory" else seconds
    base = f", beside {show(found.base)} that do not grow" if found.base > 0 else ""
    raised = Markup("<b>{}</b>: {} grows as {}<sup>{}</sup>").format(*named, number(power.value, 2))
    return raised + ends + base


def sizes_of(found: Growth) -> str:
    """What a cost grows with."""
    return "environment texels" if found.over == "environment" else found.over


def _at_paper_size(bench: Bench) -> list[Point]:
    return [
        p for p in bench.points
        if p.family == "real-time" and (p.width, p.height) == PAPER_SIZE
        and math.isfinite(p.frame.median)
    ]  # fmt: skip


def _reaching(points: Sequence[Point]) -> list[str]:
    """The techniques whose slow quartile is fast enough wherever they were timed at that size."""
    names = dict.fromkeys(p.name for p in points)
    return [n for n in names if all(p.frame.high <= PAPER_SECONDS for p in points if p.name == n)]
