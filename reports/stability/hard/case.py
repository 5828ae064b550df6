"""What a hard frame is, and how far its picture is from the one that it must show."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from reports.stability.results import Kind
from scenes.frame import Frame
from scenes.schema import Case

Make = Callable[[Path], Case]  # writes its files in the folder
Part = tuple[int, int, int, int]  # left, bottom, width and height in pixels
Draw = Callable[..., Frame]  # (case, part=None): with one technique
Expect = Callable[[Draw, Path], np.ndarray]  # the picture to hold against, (H, W, 3)

# Every case is drawn with all of them, in the words of `renderer.techniques.technique`.
QUICK = ("paper", "paper-noaa", "sampled", "sampled@1", "split", "filtered")
TECHNIQUES = (*QUICK, "best")  # which bakes every scene
FLOAT = 1e-5  # a picture's rounding errors; its coordinates have 24 bits, and lobes magnify them
DENSE = "sampled@4096"  # where its noise would hide what is looked for
SAME = {"paper": FLOAT, "paper-noaa": FLOAT, "sampled": FLOAT, "sampled@1": FLOAT}


@dataclass(frozen=True)
class Hard:
    """One hard case. Whatever else must hold, no pixel is NaN, Inf or negative.

    Attributes:
        case: makes it, with its files in a folder that all cases share.
        expect: makes the picture that it must show, if that is known.
        within: by technique, the most that the picture may be off (`off`); others are not compared.
        interior: compare only where all neighbours show the same object.
        between: the least and the most radiance of objects' pixels.
        brightest: what the brightest pixel of every picture must reach.
        silhouette: the share of pixels that may show another object than in Mitsuba; None where
            that is not compared.
        energy: by technique, how far the light on the objects may be from Mitsuba's `unoccluded`,
            as a share; others are not compared.
        refused: words of the one line that must refuse the case instead.
    """

    name: str
    kind: Kind
    must_hold: str
    why: str
    case: Make
    expect: Expect | None = None
    within: Mapping[str, float] = field(default_factory=lambda: SAME)
    interior: bool = False
    between: tuple[float, float] | None = None
    brightest: float = 0.0
    silhouette: float | None = None
    energy: Mapping[str, float] = field(default_factory=dict)
    refused: str = ""


def off(picture: np.ndarray, expected: np.ndarray, where: np.ndarray) -> tuple[float, float]:
    """How far a picture is from another: over pixels and channels, the RMS and the largest.

    Each pixel counts by its own relative difference, or a sun would hide all others; below a
    thousandth of the median by that.

    Args:
        where: (H, W) bool, the pixels that count.
    """
    a, b = picture[where].astype(float), expected[where].astype(float)
    lit = b[b > 0]
    floor = 1e-3 * np.median(lit) if lit.size else 1.0
    apart = np.nan_to_num(np.abs(a - b) / np.maximum(np.abs(b), floor), nan=np.inf)
    if not apart.size:
        return 0.0, 0.0
    return float(np.sqrt((apart**2).mean())), float(apart.max())


def twin(make: Make, seen: Callable[[np.ndarray], np.ndarray] = np.asarray) -> Expect:
    """Expect what another case shows, as `seen` maps its picture (H, W, 3) to this one's."""
    return lambda draw, folder: seen(draw(make(folder)).rgb)
