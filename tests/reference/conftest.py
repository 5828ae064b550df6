"""Small cases, with environments written for the test."""

import numpy as np
import OpenImageIO as oiio
import pytest

from scenes.schema import Camera, Case, Environment, Object
from tests.reference.cases import metal

HEIGHT = 32  # texels of a test environment, from pole to pole


@pytest.fixture
def write_sky(tmp_path):
    """Write an array (H, W, 3), or a grey value for everywhere, as an environment."""

    def write(radiance, rotation=0.0):
        pixels = np.ones((HEIGHT, 2 * HEIGHT, 3), np.float32) * np.asarray(radiance, np.float32)
        path = tmp_path / f"sky-{len(list(tmp_path.iterdir()))}.exr"
        image = oiio.ImageOutput.create(str(path))
        image.open(str(path), oiio.ImageSpec(*pixels.shape[1::-1], 3, oiio.FLOAT))
        image.write_image(np.ascontiguousarray(pixels))
        image.close()
        return Environment(name=path.stem, path=path, rotation=rotation)

    return write


@pytest.fixture
def make_case(write_sky):
    """A case with one sphere in grey light, changed as the test asks."""

    def make(sky=1.0, material=None, rotation=0.0, **changes):
        fields = {
            "id": "test",
            "scene": "test",
            "camera": Camera(origin=(0, -5, 0), target=(0, 0, 0), fov=40),
            "width": 48,
            "height": 36,
            "objects": (Object(name="ball", mesh="sphere", material=material or metal()),),
        }
        return Case(environment=write_sky(sky, rotation), **(fields | changes))

    return make
