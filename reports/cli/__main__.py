"""`python -m reports.cli` is the command too."""

from reports.cli import main

main()
