"""Scenes whose surfaces hide and light one another."""

import numpy as np
import pytest
import trimesh

from renderer.transport import stored
from renderer.transport.scene import _loaded
from scenes.schema import Camera, Material

WHITE = Material(albedo=(1.0, 1.0, 1.0), f0=0.0, roughness=0.5, metallic=0.0)
GREY = Material(albedo=(0.5, 0.5, 0.5), f0=0.0, roughness=0.5, metallic=0.0)
ABOVE = Camera(origin=(0, -4, 4), target=(0, 0, 0), fov=40)


@pytest.fixture
def _own_bakes(tmp_path, monkeypatch):
    monkeypatch.setattr(stored, "folder", lambda: tmp_path / "bakes")
    _loaded.cache_clear()


@pytest.fixture
def ball_and_plate(light, make_case):
    """A ball over a plate, which it touches nowhere."""
    parts = [("sphere", GREY, {"scale": 0.5, "position": (0, 0, 1.0)})]
    parts += [("plane", WHITE, {"scale": 4.0})]
    return make_case(light(1.0), *parts, camera=ABOVE)


@pytest.fixture
def bowl(tmp_path):
    """A thick bowl that opens upwards, as a file."""
    outside, inside = np.linspace(0, 1.5, 30), np.linspace(1.4, 0, 30)
    profile = np.concatenate(
        [
            np.stack([np.sin(outside), -np.cos(outside)], axis=1),
            0.8 * np.stack([np.sin(inside), -np.cos(inside)], axis=1),
        ]
    )
    path = tmp_path / "bowl.ply"
    trimesh.creation.revolve(profile, sections=64).export(path)
    return str(path)
