"""The ways to draw that a bench compares: what changes, and what the denoiser is given."""

import sys

import numpy as np
import pytest

from reports.run.bench.way import changed
from scenes.schema import Material
from scenes.suite import expand, load_suite
from tests.reports.small import BUNNY

CHANGES = ("light", "material", "weight", "geometry")


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(BUNNY)
    (entry,) = expand(*load_suite(str(path)))
    return entry.case


def test_a_change_of_weight_keeps_both_lobes(case):
    for step in range(4):
        materials = [o.material for o in changed(case, "weight", step).objects]
        assert all(0 < m.weight < 1 and m.masking_weight == m.weight for m in materials)
    assert len({changed(case, "weight", step) for step in range(4)}) == 4


@pytest.mark.parametrize("change", CHANGES)
def test_parameters_that_are_set_change_the_path_traced_picture(case, change):
    from reports.run.bench.path_traced import Tracer, _new_parameters, mi

    tracer = Tracer(changed(case, "weight"))
    before = tracer.draw(4, 0)
    params = mi.traverse(tracer.scene)
    for name, value in _new_parameters(tracer, change, 3).items():
        params[name] = value
    params.update()
    after = tracer.draw(4, 0)
    assert np.isfinite(after).all() and (before != after).any()
    if change == "light":
        assert after == pytest.approx(before * (1 + 3 / 8), rel=1e-3)


def test_guides_are_reflectance_and_normals_on_the_object_and_nothing_beside_it(case):
    from reports.run.bench.denoised import DenoisedTracer

    traced = DenoisedTracer(case).traced(16, 0).numpy()
    middle, corner = traced[40, 32], traced[0, 0]
    assert middle[3:6] == pytest.approx(case.objects[0].material.specular_f0, rel=1e-5)
    assert np.linalg.norm(middle[6:9]) == pytest.approx(1, abs=0.2)
    assert (corner[3:] == 0).all() and (corner[:3] > 0).any()


def test_the_reflectance_of_plastic_is_what_both_lobes_send_back(case):
    from reports.run.bench.denoised import reflectance

    material = Material(albedo=(0.5, 0.2, 0.99), roughness=0.5, metallic=0, f0=0.04)
    plastic = case.objects[0].model_copy(update={"material": material})
    assert reflectance(plastic) == pytest.approx([0.54, 0.24, 1])


def test_without_the_denoiser_one_line_says_what_is_left_out(monkeypatch):
    from reports.run.bench.denoised import unavailable

    assert unavailable() == ""
    monkeypatch.setitem(sys.modules, "mitsuba_oidn", None)
    assert "mitsuba-oidn" in unavailable() and "shadeproof[denoise]" in unavailable()


def test_samples_are_those_that_the_sampler_takes_and_fit_the_time(case):
    from reference.settings import rounded_samples
    from reports.run.bench.path_traced import SAMPLES, samples_for

    assert all(rounded_samples(k) == k for k in SAMPLES)
    large = case.model_copy(update={"width": 1920, "height": 1080})
    assert samples_for(large) == [1, 2, 4, 8]
