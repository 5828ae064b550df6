"""The gate under attack: shader bugs in copies of the renderer, each through the real gate."""
