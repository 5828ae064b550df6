"""Every figure of a comparison, one file each. To add one: a file, and a name in a list below."""

from collections.abc import Callable
from typing import Any

from reports.metrics import chroma, energy, flip, relmse, ssim
from reports.metrics.subject import Subject

Metric = Callable[[Subject], dict[str, Any]]
# Each takes a subject and returns fields of reports.results.Row.
JUDGED: tuple[Metric, ...] = (ssim.judged, energy.figures)  # what budgets can be given for
FURTHER: tuple[Metric, ...] = (ssim.further, relmse.figures, chroma.figures, flip.figures)
METRICS = (*JUDGED, *FURTHER)
