"""From a suite file to its cases."""

import shlex
import shutil
import subprocess

import numpy as np
import pytest
import trimesh

from scenes.suite import HERE, expand, load_suite


def ids(path) -> list[str]:
    return [e.case.id for e in expand(*load_suite(str(path)))]


@pytest.mark.parametrize("name", ["default", "spheres", "full", "tiny", "bench", "guard"])
def test_a_suite_gives_the_same_cases_every_time(name):
    assert expand(*load_suite(name)) == expand(*load_suite(name))


def test_environments_materials_and_axes_are_crossed(write_suite):
    path = write_suite(
        'environments = ["studio"]',
        'environments = ["studio", "sunset"]\nmaterials = ["gold", "silver"]\n'
        "[run.sweep]\nroughness = [0.2, 0.4]\nweight = [1.0, 0.5, 0.0]",
    )
    made = ids(path)
    assert len(made) == len(set(made)) == 2 * 2 * 3 * 2
    assert made[0] == "ball.studio.gold.weight=1.roughness=0.2"
    assert made[-1] == "ball.sunset.silver.weight=0.roughness=0.4"


def test_a_sweep_reaches_the_material_and_moves_both_weights(write_suite, tmp_path):
    path = write_suite("truths", "truths")
    (tmp_path / "own.toml").write_text(
        'roughness = 0.5\nmetallic = 1.0\nmetal = "Au"\nweight = 1.0\nweight_g = 0.0\n'
    )
    path.write_text(path.read_text() + 'materials = ["own.toml"]\n[run.sweep]\nweight = [0.25]\n')
    (entry,) = expand(*load_suite(str(path)))
    (ball,) = entry.case.objects
    assert (ball.material.name, ball.material.weight, ball.material.masking_weight) == (
        "own",
        0.25,
        0.25,
    )


def test_what_a_scene_changes_outlives_a_crossed_material(write_suite):
    path = write_suite('material = "copper"', 'material = { use = "copper", roughness = 0.11 }')
    path.write_text(path.read_text() + 'materials = ["gold"]\n')
    (entry,) = expand(*load_suite(str(path)))
    material = entry.case.objects[0].material
    assert (material.name, material.roughness) == ("gold", 0.11)


def test_fixed_objects_keep_their_material(write_suite):
    path = write_suite('material = "copper"', 'material = "copper"\nfixed = true')
    path.write_text(path.read_text() + 'materials = ["gold"]\n[run.sweep]\nroughness = [0.9]\n')
    (entry,) = expand(*load_suite(str(path)))
    material = entry.case.objects[0].material
    assert (material.name, material.roughness) == ("copper", 0.4)


def test_a_run_may_override_resolution_truths_techniques_and_model(write_suite):
    path = write_suite(
        'environments = ["studio"]',
        'environments = ["studio"]\nresolution = [32, 16]\ntruths = ["physical"]\n'
        'techniques = ["sampled"]\nrotation = 90.0\n[run.model]\nmasking = "smith"',
    )
    (entry,) = expand(*load_suite(str(path)))
    assert entry.case.model.masking == "smith"
    assert (entry.case.width, entry.case.height) == (32, 16)
    assert (entry.truths, entry.techniques) == (("physical",), ("sampled",))
    assert entry.case.environment.rotation == 90


def test_relative_paths_start_at_the_file_that_names_them(write_suite, tmp_path, monkeypatch):
    write_suite()
    for folder in ("scenes", "meshes", "lights", "materials"):
        (tmp_path / folder).mkdir()
    trimesh.creation.box().export(tmp_path / "meshes/box.ply")
    shutil.copy(HERE / "environments/studio.exr", tmp_path / "lights/own.exr")
    shutil.copy(HERE / "materials/gold.toml", tmp_path / "materials/own.toml")
    scene = (tmp_path / "ball.toml").read_text()
    scene = scene.replace('"sphere"', '"../meshes/box.ply"')
    scene = scene.replace('"copper"', '{ use = "../materials/own.toml", weight = 0.5 }')
    (tmp_path / "scenes/box.toml").write_text(scene)
    suite = (tmp_path / "suite.toml").read_text()
    suite = suite.replace("ball.toml", "scenes/box.toml").replace('"studio"', '"lights/own.exr"')
    (tmp_path / "suite.toml").write_text(suite)
    monkeypatch.chdir("/")
    (entry,) = expand(*load_suite(str(tmp_path / "suite.toml")))
    assert entry.case.id == "box.own"
    assert entry.case.environment.path == (tmp_path / "lights/own.exr").resolve()
    assert entry.case.objects[0].mesh == str((tmp_path / "meshes/box.ply").resolve())
    assert entry.case.objects[0].material.name == "own"


def test_every_shipped_material_is_valid(write_suite):
    names = sorted(p.stem for p in (HERE / "materials").glob("*.toml"))
    assert len(names) >= 12
    path = write_suite()
    path.write_text(path.read_text() + f"materials = {names}\n")
    assert [e.case.objects[0].material.name for e in expand(*load_suite(str(path)))] == names


def test_a_narrower_picture_shows_the_whole_width_of_the_scene(tmp_path):
    suite = (
        'description = "x"\ntechniques = ["paper"]\ntruths = ["global"]\n[[run]]\n'
        'scene = "bunnies"\nenvironments = ["studio"]\nresolution = [{}, {}]\n'
    )

    def tangents(width, height):
        path = tmp_path / "wide.toml"
        path.write_text(suite.format(width, height))
        camera = expand(*load_suite(str(path)))[0].case.camera
        vertical = np.tan(np.radians(camera.fov) / 2)
        return vertical, vertical * width / height

    own = tangents(512, 186)
    assert tangents(1024, 372) == pytest.approx(own)
    assert tangents(1920, 1080)[1] == pytest.approx(own[1])
    assert tangents(2048, 186)[0] == pytest.approx(own[0])


@pytest.mark.skipif(shutil.which("make") is None, reason="there is no make")
def test_make_hands_on_paths_with_spaces(tmp_path):
    shutil.copy(HERE.parent / "Makefile", tmp_path)
    (tmp_path / "requirements").mkdir()
    for needed in ("requirements/requirements.txt", "requirements/system.sh", "pyproject.toml"):
        (tmp_path / needed).touch()
    given = ["SUITE=my suite.toml", "OUT=my out"]
    for target in ("compare", "gate", "report", "references"):
        command = ["make", "--dry-run", "-C", str(tmp_path), target, *given]
        said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        (line,) = [s for s in said.splitlines() if s.startswith(f".venv/bin/shadeproof {target}")]
        words = shlex.split(line)
        assert ("my suite.toml" in words) == (target != "report")
        assert ("my out" in words) == (target != "references")
