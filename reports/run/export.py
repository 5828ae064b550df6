"""A case as a zip that draws it elsewhere: JSON, glTF, light, and Mitsuba's XML."""

import shutil
import tempfile
import zipfile
from pathlib import Path

import numpy as np

from reference.pack import EPOCH
from reports.export.gltf import write_gltf
from reports.run.job import Job, make_folder
from scenes.environment import load_environment
from scenes.errors import InputError
from scenes.files import read_text
from scenes.frame import write_exr, written_aside
from scenes.mesh import load_mesh
from scenes.schema import PRIMITIVES, Case, Material

HERE = Path(__file__).parent
ABOUT = HERE.parent / "export" / "README.txt"


def export(job: Job, folder: Path) -> list[tuple[Path, str]]:
    """Write `<case>.zip` for each case of a job; their paths, and what each lacks.

    Raises:
        InputError: the folder cannot be written.
    """
    make_folder(folder, "--to")
    return [_export(entry.case, folder) for entry in job.entries]


def _export(case: Case, folder: Path) -> tuple[Path, str]:
    lacks = ""
    with tempfile.TemporaryDirectory(prefix="shadeproof-") as name:
        root = Path(name)
        (root / "mitsuba").mkdir()
        (root / "case.json").write_text(_portable(case, root).model_dump_json(indent=1) + "\n")
        write_gltf(case, root / "scene.gltf")
        if problem := _write_xml(case, root / "mitsuba"):
            shutil.rmtree(root / "mitsuba")
            lacks = f"no Mitsuba XML: {problem}"
        about = read_text(ABOUT, "").replace("{case}", case.id)
        (root / "README.txt").write_text(about + (f"\nThis case has {lacks}\n" if lacks else ""))
        path = folder / f"{case.id}.zip"
        with written_aside(path) as aside, zipfile.ZipFile(aside, "w") as packed:
            for file in sorted(p for p in root.rglob("*") if p.is_file()):
                # The same case gives the same bytes.
                info = zipfile.ZipInfo(str(file.relative_to(root)), EPOCH)
                info.compress_type = zipfile.ZIP_DEFLATED
                packed.writestr(info, file.read_bytes())
    return path, lacks


def _write_xml(case: Case, folder: Path) -> str:
    """Write Mitsuba's XML; why there is none, empty where there is."""
    try:
        from reference.scene_xml import write_scene_xml  # late: all else needs no path tracer

        write_scene_xml(case, folder)
    except InputError as error:
        return error.problem
    except ModuleNotFoundError as error:
        return f"the package {error.name} is not installed (extra `reference`)"
    return ""


def _portable(case: Case, root: Path) -> Case:
    """The case with its files beside it, named from there."""
    radiance = np.ascontiguousarray(load_environment(case.environment.path).radiance, np.float32)
    write_exr(root / "environment.exr", radiance, ["R", "G", "B"])
    light = case.environment.model_copy(update={"path": Path("environment.exr")})
    objects = []
    for obj in case.objects:
        update = {"material": _with_maps(obj.material, root)}
        if obj.mesh not in PRIMITIVES:
            load_mesh(obj.mesh)
            update["mesh"] = _copied(Path(obj.mesh), root)
        objects.append(obj.model_copy(update=update))
    return case.model_copy(update={"environment": light, "objects": tuple(objects)})


def _with_maps(material: Material, root: Path) -> Material:
    named = {name: _copied(path, root) for name, path in material.maps.pictures.items()}
    maps = material.maps.model_copy(update=named)
    return material.model_copy(update={"maps": maps})


def _copied(path: Path, root: Path) -> str:
    """A file's name beside the case; of two files of one name the second gets another."""
    name, number = path.name, 1
    while (root / name).exists() and (root / name).read_bytes() != path.read_bytes():
        number += 1
        name = f"{path.stem}-{number}{path.suffix}"
    shutil.copyfile(path, root / name)
    return name
