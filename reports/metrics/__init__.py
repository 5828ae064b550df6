"""Every figure of a comparison, one file each. To add one: a file, and a line in METRICS."""

from collections.abc import Callable
from typing import Any

from reports.metrics import energy, flip, relmse, ssim
from reports.metrics.subject import Subject

# Each takes a subject and returns fields of reports.results.Row.
METRICS: tuple[Callable[[Subject], dict[str, Any]], ...] = (
    ssim.figures,
    energy.figures,
    relmse.figures,
    flip.figures,
)
