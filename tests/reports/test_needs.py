"""What a case does without is told, and only what changes no picture is called exact."""

from dataclasses import replace

import numpy as np
import pytest

from renderer import features
from renderer.features import LOBES
from renderer.techniques import technique
from reports.run.bench import needs
from reports.run.bench.needs import left_out, relmse
from scenes.schema import Camera, Case, Environment, Object
from scenes.suite import HERE

TECHNIQUES = ("sampled@16", "paper-noaa", "sampled@4")


@pytest.fixture
def case(monkeypatch):
    """A metal of GGX alone and a plastic of both lobes, in few pixels."""
    from scenes.files import read_toml
    from scenes.schema import Material

    monkeypatch.setattr(needs, "FRAMES", 1)
    monkeypatch.setattr(needs, "MAKINGS", 1)
    copper, plastic = (
        Material(**read_toml(HERE / "materials" / f"{name}.toml")) for name in ("copper", "rubber")
    )
    materials = {"metal": copper, "plastic": plastic.model_copy(update={"weight": 0.5})}
    objects = [
        Object(name=name, mesh="sphere", material=material, position=(2.0 * k - 1, 0, 0))
        for k, (name, material) in enumerate(materials.items())
    ]
    path = HERE / "environments" / "studio.exr"
    return Case(
        id="pair",
        scene="pair",
        environment=Environment(name="studio", path=path),
        camera=Camera(origin=(0, -8, 0), target=(0, 0, 0), fov=30),
        width=40,
        height=24,
        objects=objects,
    )


@pytest.fixture
def found(case):
    return {x.what: x for x in left_out(case, TECHNIQUES)}


def test_what_no_weight_asks_for_is_left_out_and_changes_nothing(found):
    for what, on in (
        ("paper-noaa: Beckmann lobe", "metal"),
        ("paper-noaa: diffuse lobe", "metal"),
        ("sampled@4: Beckmann lobe", "metal"),
        ("sampled@4: masking of Beckmann", "metal"),
        ("sampled@4: diffuse lobe", "metal"),
    ):
        assert found[what].exact and found[what].difference < 1e-9
        assert found[what].why.endswith(f"0 on {on}")


def test_what_some_object_needs_is_not_told_as_left_out_of_all(found):
    assert not any("GGX lobe" in what or "masking of GGX" in what for what in found)
    assert not any("paper-noaa: masking" in what for what in found)  # its table holds both
    assert not any("16" in what for what in found)  # the fewest samples stand for the way


def test_maps_that_nothing_reads_are_told_with_the_time_they_would_take(found):
    assert found["sampled@4: prefiltered environment"].saved_seconds > 0.01
    for told in found.values():
        assert told.saved_low <= told.saved_seconds <= told.saved_high
    assert found["sampled@4: irradiance map"].saved_seconds > 0
    assert not any("paper-noaa: environment" in what for what in found)  # it reads both


def test_a_lobe_alone_does_without_the_other_ones_map(case):
    alone = case.model_copy(update={"objects": case.objects[:1]})
    told = {x.what: x.why for x in left_out(alone, ("paper-noaa",))}
    assert "paper-noaa: environment prefiltered for Beckmann" in told
    assert "paper-noaa: irradiance map" in told
    assert told["paper-noaa: diffuse lobe"] == "its albedo is 0 on metal"


def test_what_changes_the_picture_is_not_exact(found):
    coverage = found["paper-noaa: 4 coverage samples a pixel"]
    assert not coverage.exact and coverage.difference > 1e-4


def test_a_lobe_left_out_by_mistake_is_found(case, monkeypatch):
    wrong = tuple(replace(f, needed=lambda m: False) if f.name == "DIFFUSE" else f for f in LOBES)
    for module in (features, needs):
        monkeypatch.setattr(module, "LOBES", wrong)
    found = {x.what: x for x in left_out(case, ("paper-noaa",))}
    assert not found["paper-noaa: diffuse lobe"].exact
    assert found["paper-noaa: diffuse lobe"].why == "its albedo is 0 on all objects"


def test_a_forced_feature_is_compiled_in_and_its_maps_are_read(case):
    copper = case.objects[0].material
    forced = replace(technique("paper"), forced=("D_BECKMANN",))
    assert "prefiltered_beckmann" in forced.maps(copper)
    assert "prefiltered_beckmann" not in technique("paper").maps(copper)
    assert "D_BECKMANN" in features.features(copper, forced=forced.forced)


def test_relmse_is_relative_to_the_second_frame():
    frame = np.full((2, 2, 3), 2.0)
    assert relmse(frame * 1.1, frame) == pytest.approx(0.01)


def test_a_reference_traces_no_ray_on_where_nothing_can_occlude(case, found, monkeypatch):
    assert not any("reference" in what for what in found)
    monkeypatch.setattr(needs, "FRAMES", 6)
    floor = case.objects[0].model_copy(update={"mesh": "plane", "rotate": (70, 0, 0)})
    alone = case.model_copy(update={"objects": (floor,)})
    (told,) = (x for x in left_out(alone, TECHNIQUES) if "reference" in x.what)
    assert not told.exact and told.difference < 2 * told.interval < 0.1


def test_two_black_frames_are_the_same_frame():
    black = np.zeros((4, 4, 3), np.float32)
    assert relmse(black, black) == 0
