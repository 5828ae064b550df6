"""What the vertices of an object carry for the shaders, in columns."""

import numpy as np

from scenes.schema import Object
from scenes.surface import surface

# First column and number of columns of each texture in shaders/vary.glsl.
COLUMNS = {"vertex_uv": (0, 2), "vertex_tangent": (2, 4), "vertex_albedo": (6, 3)}
COLUMNS |= {"vertex_numbers": (9, 3)}
WIDTH = 12
PLACES = {"uv": 0, "tangent": 2, "albedo": 6, "roughness": 9, "metallic": 10, "weight": 11}


def carried(obj: Object, vertices: int) -> np.ndarray:
    """(vertices, WIDTH) float32, 1 where the material's numbers hold; no columns if it needs none.

    Raises:
        InputError: the mesh lacks what the material's maps need.
    """
    found = surface(obj).carried
    if not found:
        return np.empty((vertices, 0), np.float32)
    columns = np.ones((vertices, WIDTH), np.float32)
    for name, values in found.items():
        columns[:, PLACES[name] : PLACES[name] + values.shape[1]] = values
    return columns
