"""Small files to read, and the check that a mistake ends in one useful line."""

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

SCENE = """\
description = "one sphere"
resolution = [64, 48]

[camera]
origin = [0.0, -4.0, 0.0]
target = [0.0, 0.0, 0.0]
fov = 30.0

[[object]]
name = "ball"
mesh = "sphere"
material = "copper"
"""

SUITE = """\
description = "one case"
techniques = ["paper"]
truths = ["global"]

[[run]]
scene = "ball.toml"
environments = ["studio"]
"""


@pytest.fixture
def write_suite(tmp_path):
    """Write a scene and a suite after replacing `old` by `new` in both; return the suite's path."""

    def write(old: str = "", new: str = "") -> Path:
        assert old in SCENE + SUITE
        scene, suite = (text.replace(old, new) if old else text for text in (SCENE, SUITE))
        (tmp_path / "ball.toml").write_text(scene, encoding="utf-8")
        (tmp_path / "suite.toml").write_text(suite, encoding="utf-8")
        return tmp_path / "suite.toml"

    return write


@pytest.fixture
def write_image(tmp_path):
    """Write an image (H, W, C) in the folder of the test, and return its path."""

    def write(name: str, pixels: np.ndarray, channels: tuple[str, ...] = (), **window: int) -> Path:
        pixels = np.ascontiguousarray(pixels, np.float32)
        spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], oiio.FLOAT)
        if channels:
            spec.channelnames = channels
        for key, value in window.items():
            setattr(spec, key, value)
        path = tmp_path / name
        image = oiio.ImageOutput.create(str(path))
        assert image.open(str(path), spec) and image.write_image(pixels) and image.close()
        return path

    return write
