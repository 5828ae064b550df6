"""A case as files that other programs read, and what they make of it."""

import json
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.ndimage import maximum_filter

from reference.batches import PathTracer
from reference.scene_xml import write_scene_xml
from reference.variant import mitsuba
from reports.export.gltf import Y_UP, base_colour, write_gltf
from scenes.environment import load_environment
from scenes.frame import load_frame
from scenes.mesh import world_mesh
from scenes.schema import Case
from scenes.suite import expand, load_suite


@pytest.fixture(scope="module")
def case() -> Case:
    suite, path = load_suite("tiny")
    return expand(suite, path)[0].case


@pytest.fixture(scope="module")
def unpacked(shadeproof, case, tmp_path_factory):
    folder = tmp_path_factory.mktemp("export")
    code, out, err = shadeproof("export", "--suite", "tiny", "--to", folder)
    assert code == 0 and f"{case.id}.zip" in out, out + err
    with zipfile.ZipFile(folder / f"{case.id}.zip") as packed:
        packed.extractall(folder / "case")
    return folder / "case"


def test_the_case_stands_beside_its_files(unpacked, case):
    told = Case.model_validate_json((unpacked / "case.json").read_text())
    assert told.id == case.id and not told.environment.path.is_absolute()
    light = load_frame(unpacked / told.environment.path).rgb
    assert np.array_equal(light, load_environment(case.environment.path).radiance)


def test_gltf_holds_the_geometry_where_it_stands(unpacked, case):
    scene = trimesh.load(unpacked / "scene.gltf")
    for obj in case.objects:
        found = scene.geometry[obj.name].copy()
        found.apply_transform(scene.graph.get(obj.name)[0])
        wanted = world_mesh(obj).vertices @ Y_UP[:3, :3].T
        assert found.bounds == pytest.approx(np.array([wanted.min(0), wanted.max(0)]), abs=1e-5)


def test_gltf_says_what_it_can_of_materials_and_camera(unpacked, case):
    tree = json.loads((unpacked / "scene.gltf").read_text())
    materials = {m["name"]: m for m in tree["materials"]}
    for obj in case.objects:
        told = materials[obj.name]
        pbr = told["pbrMetallicRoughness"]
        assert pbr["baseColorFactor"][:3] == pytest.approx(base_colour(obj.material))
        assert pbr["roughnessFactor"] == obj.material.roughness
        assert told["extras"]["shadeproof"]["weight"] == obj.material.weight
        eta = sum(obj.material.f0.eta) / 3
        assert told["extensions"]["KHR_materials_ior"]["ior"] == pytest.approx(eta)
    (camera,) = tree["cameras"]
    assert np.degrees(camera["perspective"]["yfov"]) == pytest.approx(case.camera.fov)
    pose = np.reshape(tree["nodes"][-1]["matrix"], (4, 4)).T
    eye = Y_UP[:3, :3] @ case.camera.origin
    towards = Y_UP[:3, :3] @ np.subtract(case.camera.target, case.camera.origin)
    assert pose[:3, 3] == pytest.approx(eye)
    assert -pose[:3, 2] == pytest.approx(towards / np.linalg.norm(towards))
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1)


RENDER = """
import sys, mitsuba as mi
mi.set_variant("llvm_ad_rgb")
scene = mi.load_file(sys.argv[1], spp=256)
mi.Bitmap(mi.render(scene)).write(sys.argv[2])
"""


def test_mitsuba_alone_draws_the_truth_from_its_xml(unpacked, case, tmp_path):
    """The exported XML, rendered by Mitsuba in a process that knows nothing of ours."""
    script = tmp_path / "render.py"
    script.write_text(RENDER)
    mitsuba()  # which finds the LLVM library for the environment
    xml = unpacked / "mitsuba/scene.xml"
    command = [sys.executable, str(script), str(xml), str(tmp_path / "out.exr")]
    subprocess.run(command, check=True, timeout=300, cwd=tmp_path)
    theirs = load_frame(tmp_path / "out.exr").rgb
    ours = PathTracer("physical", 256).render(case)
    for obj in case.judged:
        on = ours.ids == case.index(obj.name)
        assert theirs[on].mean() == pytest.approx(ours.rgb[on].mean(), rel=0.01)
    away = maximum_filter(ours.ids, 5) == 0  # what a pixel holds of an object is noisy
    assert theirs[away] == pytest.approx(ours.rgb[away], rel=0.02, abs=0.01)


def test_a_material_without_stock_plugin_is_told(shadeproof, tmp_path):
    text = Path(load_suite("surfaces")[1]).read_text()
    assert "brushed" in text
    code, out, _ = shadeproof("export", "--suite", "surfaces", "--filter", "worn", "--to", tmp_path)
    assert code == 0 and "no Mitsuba XML" in out


def test_the_same_case_gives_the_same_bytes(shadeproof, case, tmp_path):
    for name in "ab":
        shadeproof("export", "--suite", "tiny", "--to", tmp_path / name)
    first, second = ((tmp_path / n / f"{case.id}.zip").read_bytes() for n in "ab")
    assert first == second


def test_files_go_beside_each_other(case, tmp_path):
    write_gltf(case, tmp_path / "scene.gltf")
    write_scene_xml(case, tmp_path)
    assert {"scene.gltf", "scene.xml", "environment.exr"} <= {p.name for p in tmp_path.iterdir()}
