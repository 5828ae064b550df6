"""Small valid files of every kind that users hand in, made by code; some kinds in several ways."""

import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import trimesh

from reference.pack import pack
from reference.store import Store
from reports.speed.points import Bench
from scenes.frame import Frame, save_frame
from scenes.suite import expand, load_suite
from tests.reports.benches import bunnies, full_bench
from tests.reports.pages import results, row

SUITE = """\
description = "one case"
techniques = ["paper", "sampled@4"]
truths = ["unoccluded", "global"]
allow_inconclusive = true

[model]
masking = "smith"

[reference]
samples_per_batch = 4
max_samples = 40

[[run]]
scene = "scene.toml"
environments = ["sky.exr"]
rotation = 30.0
materials = ["brass.toml"]
resolution = [32, 16]
split_model = false
[run.sweep]
weight = [[0.5, 0.5]]

[[budget]]
technique = "paper"
truth = "global"
object = "thing"
energy_local = 0.3
ssim = 0.2
reason = "small"
"""
SCENE = """\
description = "one thing"
resolution = [32, 16]

[camera]
origin = [0.0, -4.0, 3.0]
target = [0.0, 0.0, 0.0]
up = [0.0, 0.0, 1.0]
fov = 30.0

[[object]]
name = "thing"
mesh = "plane"
material = { use = "brass.toml", roughness = 0.3 }
position = [0.0, 0.0, 0.1]
rotate = [0.0, 10.0, 0.0]
scale = [1.0, 2.0, 1.0]
judged = true
small = "a test"

[[object]]
name = "floor"
mesh = "plane"
material = "white_plastic"
fixed = true
judged = false
height = 0.5
rotate = [30.0, 0.0, 0.0]
"""
MATERIAL = """\
description = "brass"
source = "chosen"
albedo = [0.3, 0.1, 0.04]
metal = [0.91, 0.78, 0.42]
f0 = 0.04
roughness = 0.4
metallic = 0.9
weight = [0.25, 0.75]
weight_g = 0.25
"""
EXRS = {  # compression, pixel type, channels, tile size
    "zip": ("zip", oiio.FLOAT, "RGB", 0),
    "none": ("none", oiio.HALF, "RGB", 0),
    "piz": ("piz", oiio.HALF, "RGBA", 0),
    "dwaa": ("dwaa:45", oiio.HALF, "RGB", 0),
    "rle": ("rle", oiio.FLOAT, "Y", 0),
    "b44": ("b44", oiio.HALF, "RGB", 0),
    "pxr24": ("pxr24", oiio.FLOAT, "RGBZ", 0),
    "tiled": ("zip", oiio.FLOAT, "RGB", 16),
}
IDS = np.repeat([[1, 2]], 16, axis=1).repeat(16, axis=0).astype(np.uint8)  # left, right
HERE = "@here@"  # in a case's JSON, where the folder's absolute path belongs
SKY = np.random.default_rng(1).uniform(0.1, 2, (16, 32, 4)).astype(np.float32)


def corpus() -> dict[str, dict[str, bytes]]:
    """Valid files by kind and variant; what names a file names it as `valid_folder` lays it."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        found = {
            "suite": {"toml": SUITE.encode()},
            "scene": {"toml": SCENE.encode()},
            "material": {"toml": MATERIAL.encode()},
            "exr": {name: _exr(folder, *how) for name, how in EXRS.items()},
            "hdr": {"rle": _hdr(folder, SKY), "flat": _hdr(folder, SKY[:, :4])},
            **_meshes(),
            "results": {"json": results([row()]).model_dump_json(indent=1).encode()},
            "bench": {"json": _bench().model_dump_json(indent=1).encode()},
        }
        save_frame(Frame(SKY[..., :3], IDS), folder / "half.exr")
        found["half"] = {form: (folder / f"half.{form}").read_bytes() for form in ("exr", "json")}
        lay(folder, found)
        (entry,) = expand(*load_suite(str(folder / "suite.toml")))
        case = entry.case.model_dump_json(indent=1).replace(str(folder.resolve()), HERE)
        # Cycles has no mixtures.
        case = case.replace('"weight": 0.5', '"weight": 1.0').replace(
            '"metallic": 0.9', '"metallic": 1.0'
        )
        found["case"] = {"json": case.encode()}
        found["refs"] = {"zip": _pack(folder)}
    return found


def lay(folder: Path, files: dict[str, dict[str, bytes]]) -> None:
    """Write a suite and all that it names."""
    for name, kind in (
        ("suite.toml", "suite"),
        ("scene.toml", "scene"),
        ("brass.toml", "material"),
    ):
        (folder / name).write_bytes(next(iter(files[kind].values())))
    (folder / "sky.exr").write_bytes(files["exr"]["zip"])


def _bench() -> Bench:
    """One record of each sort, so that a mutation hits each as often as the others."""
    whole = full_bench()
    first = {name: getattr(whole, name)[:1] for name in ("equal", "growths", "left_out", "lobes")}
    return whole.model_copy(update={"points": [p for p in bunnies() if p.gpu], **first})


def _exr(folder: Path, compression: str, depth, channels: str, tile: int) -> bytes:
    spec = oiio.ImageSpec(32, 16, len(channels), depth)
    spec.channelnames = tuple(channels)
    spec.attribute("compression", compression)
    spec.tile_width = spec.tile_height = tile
    return _written(folder / "image.exr", spec, SKY[..., : len(channels)])


def _hdr(folder: Path, pixels: np.ndarray) -> bytes:
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, oiio.FLOAT)
    return _written(folder / "image.hdr", spec, pixels[..., :3])


def _written(path: Path, spec: oiio.ImageSpec, pixels: np.ndarray) -> bytes:
    image = oiio.ImageOutput.create(str(path))
    assert image.open(str(path), spec) and image.write_image(np.ascontiguousarray(pixels))
    assert image.close()
    return path.read_bytes()


def _meshes() -> dict[str, dict[str, bytes]]:
    bare = trimesh.creation.icosahedron()
    ball = trimesh.creation.icosphere(subdivisions=1)
    ball.vertex_normals  # noqa: B018 - computed once, it is exported too
    scene = trimesh.Scene()
    turned = trimesh.transformations.rotation_matrix(0.5, [0, 0, 1], [1, 2, 3])
    scene.add_geometry(ball, transform=turned)
    scene.add_geometry(bare, transform=np.diag([-1.0, 1, 1, 1]))
    return {
        "ply": {
            "binary": ball.export(file_type="ply", vertex_normal=True),
            "ascii": bare.export(file_type="ply", encoding="ascii"),
            "quads": QUADS.encode(),
        },
        "obj": {
            "bare": bare.export(file_type="obj").encode(),
            "normals": ball.export(file_type="obj", include_normals=True).encode(),
            "quads": OBJ.encode(),
        },
        "stl": {
            "binary": bare.export(file_type="stl"),
            "ascii": bare.export(file_type="stl_ascii").encode(),
        },
        "glb": {
            "scene": scene.export(file_type="glb"),
            "normals": ball.export(file_type="glb", include_normals=True),
        },
    }


CORNERS = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
SIDES = ("0 1 3 2", "4 6 7 5", "0 4 5 1", "2 3 7 6", "0 2 6 4", "1 5 7 3")
QUADS = (
    "ply\nformat ascii 1.0\ncomment a cube\nelement vertex 8\nproperty float x\nproperty float y\n"
    "property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
    + "".join(f"{x} {y} {z}\n" for x, y, z in CORNERS)
    + "".join(f"4 {side}\n" for side in SIDES)
)
OBJ = (
    "mtllib cube.mtl\no cube\nusemtl paint\n"
    + "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
    + "vt 0 0\nvt 1 1\nvn 0 0 1\n"
    + "".join(
        "f " + " ".join(f"{int(i) + 1}/1/1" for i in side.split()) + "\n" for side in SIDES[:5]
    )
    + "f -8//-1 -4//-1 -3//-1\n"
)


def fill(folder: Path, store: Path) -> None:
    """Made-up references of the suite in `folder`, eight batches, nearly alike."""
    suite, path = load_suite(str(folder / "suite.toml"))
    (entry,) = expand(suite, path)
    case = entry.case
    shape, rng = (case.height, case.width, 3), np.random.default_rng(2)
    ids = np.zeros(shape[:2], np.uint8)
    ids[2:14, 4:28] = 1
    picture = rng.uniform(0.5, 1, shape).astype(np.float32)
    for number in range(8):
        rgb = picture * rng.uniform(0.99, 1.01, shape).astype(np.float32)
        frame = Frame(rgb, ids, 1.0, {"samples": 4, "seed": number}, {"unoccluded": rgb})
        traced = ids > 0
        Store(store).save(case, "model", suite.reference, number, frame, traced)


def _pack(folder: Path) -> bytes:
    fill(folder, folder / "store")
    suite, path = load_suite(str(folder / "suite.toml"))
    wanted = [(e.case, "model", suite.reference) for e in expand(suite, path)]
    pack(wanted, Store(folder / "store"), folder / "a.refs", "fuzz")
    return (folder / "a.refs").read_bytes()
