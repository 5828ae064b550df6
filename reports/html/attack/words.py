"""Figures by the names that the report gives them."""

import re

from reports.html.figures import METRICS

NAMES = {
    name: metric.label if metric.label.isupper() else metric.label.lower()
    for name, metric in METRICS.items()
}


def plainly(text: str) -> str:
    """A text that names fields of results.json, in words."""
    return re.sub(rf"\b({'|'.join(NAMES)})\b", lambda found: NAMES[found[0]], text)
