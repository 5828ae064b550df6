"""Where the labels of points go, so that none lies on another."""

from collections.abc import Sequence
from dataclasses import dataclass

from reports.speed.pareto import Standing

WIDTH, HEIGHT = 310, 250  # px: a plot on a narrow screen
LETTER, LINE, MARK = 5.9, 12, 10  # px: width of a letter, height of a label, size of a mark
# Lines fall from left to right and the front's stair leaves a point to the right, so that the
# corners below on the left and above on the right are the clearest.
SIDES = (
    "below-left", "above-right", "left", "right", "below", "above", "below-right", "above-left",
)  # fmt: skip
ORDER: dict[Standing | None, int] = {"front": 0, "near": 1, "beaten": 2, None: 3}
Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class Label:
    """A label and its point: x and y in percent of the plot, and where the point stands."""

    x: float
    y: float
    text: str
    standing: Standing | None


def places(labels: Sequence[Label]) -> list[str]:
    """The side of its point on which each label goes; empty where there is no room for it.

    Those on the front choose first; then the longer ones, which are names.
    """
    taken = [_box(label, "mark") for label in labels if label.standing]
    chosen = [""] * len(labels)
    order = sorted(
        (i for i, label in enumerate(labels) if label.standing),
        key=lambda i: (ORDER[labels[i].standing], -len(labels[i].text)),
    )
    for i in order:
        own = _box(labels[i], "mark")
        for side in SIDES:
            box = _box(labels[i], side)
            inside = box[0] >= 0 and box[1] >= 0 and box[2] <= WIDTH and box[3] <= HEIGHT
            if inside and not any(_meet(box, other) for other in taken if other != own):
                taken.append(box)
                chosen[i] = side
                break
    return chosen


def _box(label: Label, side: str) -> Box:
    """Left, top, right and bottom in px."""
    x, y = label.x / 100 * WIDTH, label.y / 100 * HEIGHT
    wide, gap, near = LETTER * len(label.text), MARK / 2 + 2, MARK / 4
    middle = (x - wide / 2, x + wide / 2)
    boxes = {
        "mark": (x - MARK / 2, y - MARK / 2, x + MARK / 2, y + MARK / 2),
        "below-left": (x - near - wide, y + near, x - near, y + near + LINE),
        "above-right": (x + near, y - near - LINE, x + near + wide, y - near),
        "below-right": (x + near, y + near, x + near + wide, y + near + LINE),
        "above-left": (x - near - wide, y - near - LINE, x - near, y - near),
        "right": (x + gap, y - LINE / 2, x + gap + wide, y + LINE / 2),
        "left": (x - gap - wide, y - LINE / 2, x - gap, y + LINE / 2),
        "above": (middle[0], y - gap - LINE, middle[1], y - gap),
        "below": (middle[0], y + gap, middle[1], y + gap + LINE),
    }
    return boxes[side]


def _meet(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
