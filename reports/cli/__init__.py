"""The command `shadeproof`: options in, exit code out (0 good, 1 gate failed, 2 could not work)."""

# A module of commands counts once it is imported; the help lists them in this order.
# ruff: noqa: F401, I001
from reports.cli import judging, changing, references, measuring, planning, limits, attacking
from reports.cli import stability, approving, doctor, exporting, viewing
from reports.cli.main import main

__all__ = ["main"]
