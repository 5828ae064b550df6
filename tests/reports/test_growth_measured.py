"""What the growth of costs is measured on: each axis grows alone, by as much as it says."""

import numpy as np
import pytest

from renderer.techniques import technique
from reports.progress import reporting
from reports.run.bench import growth
from reports.run.bench.growth import STEPS, Sizes, grown
from scenes.environment import load_environment
from scenes.mesh import load_mesh

TINY = Sizes(
    heights=(9, 18, 36, 72),
    sampled_up_to=36,
    subdivisions=(0, 1, 2, 3),
    materials=(1, 2, 3, 4),
    samples=(4, 8, 16, 32),
    maps=(8, 16),
    picture=18,
)


@pytest.fixture(scope="module")
def found():
    with reporting(STEPS) as report:
        made = grown(report, TINY)
        assert report.done == STEPS
    return {(g.over, g.technique, g.cost): g for g in made}


def test_every_axis_is_measured_for_every_technique_that_can(found):
    frames = {(over, name) for over, name, cost in found if cost == "frame"}
    assert len(frames) == 3 + 3 + 3 + 1 + 2
    assert ("samples", "sampled@N") in frames
    assert {(over, cost) for over, _, cost in found if cost != "frame"} == {
        ("pixels", "memory"),
        ("triangles", "memory"),
        ("environment", "memory"),
        ("environment", "precomputation"),
    }


def test_sizes_are_those_that_were_drawn(found):
    assert found["pixels", "paper", "frame"].sizes == [16 * 9, 32 * 18, 64 * 36, 128 * 72]
    assert len(found["pixels", "sampled@16", "frame"].sizes) == 3
    assert found["triangles", "paper", "frame"].sizes == [20, 80, 320, 1280]
    assert found["environment", "paper", "frame"].sizes == [128, 512]


def test_every_value_is_a_time_or_a_size_and_says_how_often_it_was_measured(found):
    for (_, _, cost), told in found.items():
        assert len(told.values) == len(told.frames) == len(told.sizes)
        assert all(v >= 0 for v in told.values)
        assert set(told.frames) == ({9} if cost == "frame" else {1})
        if cost != "memory":
            assert min(told.values) > 0


def test_slow_frames_are_timed_fewer_times(monkeypatch):
    monkeypatch.setattr(growth, "_seconds", lambda _: 1.5)
    case = growth._case([growth._object()], 9)
    assert growth._cost(case, technique("paper-noaa"), precompute=False).frames == 3


def test_only_the_number_of_materials_grows_over_materials():
    few, many = (growth._row("sphere", n) for n in (1, 16))
    assert len({o.material for o in few}) == 1 and len({o.material for o in many}) == 16
    assert [(o.mesh, o.position, o.height) for o in few] == [
        (o.mesh, o.position, o.height) for o in many
    ]


def test_a_resampled_environment_keeps_its_light(tmp_path):
    small = load_environment(growth._resampled(64, tmp_path)).radiance
    whole = load_environment(growth.SHELF).radiance
    assert small.shape == (64, 128, 3)
    assert small.mean() == pytest.approx(whole.mean(), rel=0.1)
    assert (
        np.corrcoef(small[32, :, 0], whole[whole.shape[0] // 2, :: whole.shape[1] // 128, 0])[0, 1]
        > 0.5
    )  # and its place


def test_a_ball_has_the_normals_of_a_sphere(tmp_path):
    ball = load_mesh(growth._ball(2, tmp_path))
    assert ball.closed and len(ball.faces) == 320
    np.testing.assert_allclose(ball.normals, ball.vertices, atol=1e-6)
