"""What docs/paper.md says that the technique `paper` takes.

Written here again: read from the renderer, it would change along with it.
"""

POINTS = 1024  # of a texel of a prefiltered map, Hammersley's
LEVELS = 6  # of a prefiltered map
SIZES = {  # width and height
    "irradiance_map": (16, 16),
    "prefiltered_ggx": (512, 256),
    "prefiltered_beckmann": (512, 256),
    "table_ggx": (128, 128),
    "table_beckmann": (128, 128),
}
