"""Figures of many powers of ten as people read them."""

import math
import re

from reports.html.figures import NONE, digits

NAMES = {"n.v": "n·v", "n.l": "n·l", "h.v": "h·v"}


def departure(value: float | None, places: int = 2) -> str:
    """A figure that is about 1 as its departure from it, such as 1 − 2.1e−5."""
    if value is None or not 0 < abs(value - 1) < 0.0999:
        return figure(value, max(places, 3))
    return f"1 {'−' if value < 1 else '+'} {figure(abs(value - 1), places)}"


def figure(value: float | None, places: int = 2) -> str:
    """A figure to some digits, such as 3.1e−6; a dash where nothing was tried."""
    if value is None:
        return NONE
    if math.isnan(value):
        return "NaN"
    if math.isinf(value):
        return "−∞" if value < 0 else "∞"
    value = float(f"{value:.{places}g}")
    if value == 0 or 1e-3 <= abs(value) < 1e4:
        return digits(value)
    mantissa, power = f"{value:.{places - 1}e}".split("e")
    mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
    return f"{mantissa}e{int(power)}".replace("-", "−")


def input_value(value: float) -> str:
    """A value on an axis; what is just below 1 as such."""
    return departure(value) if 0 < 1 - value < 1e-3 else figure(value, 3)


def name(of: str) -> str:
    """An input as it is written in the field."""
    return NAMES.get(of, of)


def prose(text: str) -> str:
    """A sentence in which a program wrote figures such as 7.6e-01, as people read them."""
    return re.sub(r"-?\b\d(\.\d+)?e[+-]\d\d\b", lambda found: figure(float(found[0])), text)
