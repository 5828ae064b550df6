"""The two renderers from outside that ship as examples: sound by the doctor, and judged."""

import importlib.util
import shutil
import sys

import numpy as np
import pytest

from reports.candidates import Command
from reports.outside import three_pbr
from reports.outside.shared import averaged, joined, unturned
from reports.run.doctor import examine
from scenes.frame import write_exr
from scenes.schema import Camera, Case, Environment, Material, Object

HAS_VTK = importlib.util.find_spec("vtk") is not None
HAS_THREE = three_pbr.BUILD.is_dir() and any(map(shutil.which, three_pbr.CHROMIUM))
NEEDS_VTK = pytest.mark.skipif(not HAS_VTK, reason="needs vtk: pip install 'shadeproof[outside]'")
NEEDS_THREE = pytest.mark.skipif(
    not HAS_THREE, reason="needs chromium, and npm install --prefix reports/outside/three"
)


@pytest.mark.long
@pytest.mark.parametrize(
    "name",
    [pytest.param("vtk_pbr", marks=NEEDS_VTK), pytest.param("three_pbr", marks=NEEDS_THREE)],
)
def test_the_doctor_finds_nothing_wrong(name):
    found = examine(Command(f"{sys.executable} -m reports.outside.{name} {{case}} {{out}}", 300))
    assert found.sound, (found.found, found.after, found.lost)


def test_exposures_are_joined_to_light_beyond_8_bits():
    light = np.array([[[1e-2, 0.5, 3.0], [40.0, 200.0, 900.0]]], np.float32)

    def shoot(factor):
        return np.round(255 * np.clip(light * factor, 0, 1) ** (1 / 2.2)).astype(np.uint8)

    found = joined(shoot, lambda shown: shown**2.2)
    assert found == pytest.approx(light, rel=0.05)


def test_a_turned_map_shows_the_same_columns(tmp_path):
    radiance = np.random.default_rng(1).uniform(0, 1, (8, 16, 3)).astype(np.float32)
    write_exr(tmp_path / "map.exr", radiance, ["R", "G", "B"])

    def case(rotation):
        metal = Material(roughness=0.5, metallic=1.0, metal="Ag")
        return Case(
            id="c", scene="c", width=8, height=8,
            environment=Environment(name="m", path=tmp_path / "map.exr", rotation=rotation),
            camera=Camera(origin=(0, -4, 0), target=(0, 0, 0), fov=40),
            objects=(Object(name="o", mesh="sphere", material=metal),),
        )  # fmt: skip

    assert np.array_equal(unturned(case(0.0)), radiance)
    # The column seen at azimuth 0 is u = rotation / 360.
    assert unturned(case(45.0))[:, 0] == pytest.approx(radiance[:, 2])
    between = unturned(case(360 / 32))[:, 0]
    assert between == pytest.approx((radiance[:, 0] + radiance[:, 1]) / 2)


def test_squares_are_averaged():
    picture = np.arange(4 * 6 * 3, dtype=float).reshape(4, 6, 3)
    assert averaged(picture, 2).shape == (2, 3, 3)
    assert averaged(picture, 2)[0, 0] == pytest.approx(picture[:2, :2].mean(axis=(0, 1)))
