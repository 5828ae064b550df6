"""Figures of many powers of ten as people read them."""

import math

from reports.html.figures import NONE, digits

NAMES = {"n.v": "n·v", "n.l": "n·l", "h.v": "h·v"}


def figure(value: float | None, places: int = 2) -> str:
    """A figure to some digits, such as 3.1e−6; a dash where nothing was tried."""
    if value is None:
        return NONE
    if math.isnan(value):
        return "NaN"
    if math.isinf(value):
        return "−∞" if value < 0 else "∞"
    if value == 0 or 1e-3 <= abs(value) < 1e4:
        return digits(float(f"{value:.{places}g}")) if places < 3 else _plain(f"{value:.{places}g}")
    mantissa, power = f"{value:.{places - 1}e}".split("e")
    mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
    return _plain(f"{mantissa}e{int(power)}")


def input_value(value: float) -> str:
    """A value on an axis; what is just below 1 as such."""
    if 0 < 1 - value < 1e-3:
        return f"1 − {figure(1 - value)}"
    return figure(value, 3)


def name(of: str) -> str:
    """An input as it is written in the field."""
    return NAMES.get(of, of)


def _plain(text: str) -> str:
    return text.replace("-", "−")
