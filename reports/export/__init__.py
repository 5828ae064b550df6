"""A case in files that other programs read."""
