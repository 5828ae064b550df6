"""Into how many parts a pixel is divided for coverage, by how large triangles are in the picture.

Four coverage samples tell a pixel's normals where triangles are larger than it: between their
vertices normals turn evenly. Where a pixel holds many triangles, a smooth metal mirrors as many
places, and needs a sample for each.
"""

from collections.abc import Iterable
from functools import lru_cache
from math import inf

import numpy as np

from renderer.view import View, covered
from scenes.mesh import load_mesh, placement
from scenes.schema import Object

PARTS = 1.5  # at least, along the side of most triangles
MOST_SAMPLES = 1 << 24  # of coverage in a picture: 400 megabytes


def grid_of(
    objects: Iterable[Object], camera: View, size: tuple[int, int], most: int, samples: int
) -> int:
    """Parts of a pixel per axis, a power of 2 up to `most`, so that most triangles of the object
    with the smallest ones span PARTS of them.

    Args:
        size: width and height of the picture.
        samples: of coverage in each part.
    """
    side = min((_side(o, camera, size[1]) for o in objects), default=inf)
    width, height = covered(objects, camera, size)[2:]
    most = min(most, (MOST_SAMPLES / max(width * height * samples, 1)) ** 0.5)
    grid = 1
    while 2 * grid <= most and grid < PARTS / side:
        grid *= 2
    return grid


def _side(obj: Object, camera: View, height: int) -> float:
    """The root of the median area of an object's triangles, in pixels, in front of the eye."""
    matrix = placement(obj)
    middles, normals = _triangles(obj.mesh)
    depth = (middles @ matrix[:3, :3].T + matrix[:3, 3] - camera.eye) @ camera.forward
    if not (depth > 0).any():
        return inf
    # Areas become those of the images: the cofactor matrix turns them.
    cofactor = np.linalg.det(matrix[:3, :3]) * np.linalg.inv(matrix[:3, :3])
    area = np.linalg.norm(normals @ cofactor, axis=1)
    pixel = 2 * np.linalg.norm(camera.up) / height  # at distance 1
    seen = depth > 0
    return max(float(np.median(np.sqrt(area[seen]) / depth[seen]) / pixel), 1e-9)


@lru_cache(maxsize=16)
def _triangles(mesh: str) -> tuple[np.ndarray, np.ndarray]:
    """Each triangle's middle and its normal as long as its area, (m, 3) float64."""
    loaded = load_mesh(mesh)
    corners = loaded.vertices.astype(float)[loaded.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    return corners.mean(axis=1), normals
