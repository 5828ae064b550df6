"""The command `shadeproof`: options in, exit code out (0 good, 1 gate failed, 2 could not work)."""

# A module of commands counts once it is imported; the help lists them in this order.
from reports.cli import judging, references, measuring, planning, limits, attacking, stability  # noqa: F401, I001  for their commands, in this order
from reports.cli.main import main

__all__ = ["main"]
