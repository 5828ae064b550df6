"""three.js in headless Chromium as a candidate.

    npm install --prefix reports/outside/three
    shadeproof doctor --candidate '.venv/bin/python -m reports.outside.three_pbr {case} {out}'

MeshPhysicalMaterial has one GGX lobe: a mixture is drawn by its roughness alone. No shadows fall
from one surface on another in the light of an environment.
"""

import base64
import shutil
import sys
from pathlib import Path

import numpy as np

from reports.export.gltf import Y_UP, base_colour
from reports.outside.shared import answer, averaged, unturned
from scenes.mesh import world_mesh
from scenes.schema import Case, Object

HERE = Path(__file__).parent / "three"
BUILD = HERE / "node_modules/three/build"
ORIGIN = "http://three.test"  # no request leaves the browser: each is answered here
SCALE = 2  # pixels drawn for each, aside
CHROMIUM = ("chromium", "google-chrome")
# WebGL without a GPU.
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def draw(case: Case) -> np.ndarray:
    """The case as linear radiance, (h, w, 3) float32."""
    from playwright.sync_api import sync_playwright

    browser_path = next(filter(None, map(shutil.which, CHROMIUM)), None)
    if browser_path is None or not BUILD.is_dir():
        sys.exit("needs chromium, and three.js: npm install --prefix reports/outside/three")
    width, height = SCALE * case.width, SCALE * case.height
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=browser_path, args=FLAGS)
        page = browser.new_page()
        page.route("**/*", _answer)
        page.goto(f"{ORIGIN}/page.html")
        page.wait_for_function("window.ready")
        text = page.evaluate("(told) => window.draw(told)", _told(case, width, height))
        browser.close()
    pixels = np.frombuffer(base64.b64decode(text), np.float32).reshape(height, width, 4)
    return averaged(pixels[::-1, :, :3], SCALE).astype(np.float32)


def _answer(route) -> None:
    name = route.request.url.removeprefix(ORIGIN)
    folder = HERE if name == "/page.html" else BUILD.parent
    path = folder / name.lstrip("/")
    if path.is_file():
        route.fulfill(path=path)
    else:
        route.abort()


def _told(case: Case, width: int, height: int) -> dict:
    """The case in three.js' space, y up, as the page's script reads it."""
    light = unturned(case)
    # Its column 0 lies at -x, ours at +y, which is -z there: a quarter turn; its row 0 is below.
    light = np.roll(light, light.shape[1] // 4, axis=1)[::-1]
    pixels = np.dstack([light, np.ones(light.shape[:2])])
    turned = {
        n: (Y_UP[:3, :3] @ getattr(case.camera, n)).tolist() for n in ("origin", "target", "up")
    }
    reach = max(float(np.abs(world_mesh(o).vertices).max()) for o in case.objects)
    far = 4 * (reach + float(np.linalg.norm(case.camera.origin)))
    return {
        "width": width,
        "height": height,
        "camera": turned | {"fov": case.camera.fov, "near": far / 1e4, "far": far},
        "light": {
            "width": light.shape[1],
            "height": light.shape[0],
            "pixels": _text(pixels, "<f4"),
        },
        "objects": [_object(o) for o in case.objects],
    }


def _object(obj: Object) -> dict:
    mesh, material = world_mesh(obj), obj.material
    return {
        "vertices": _text(mesh.vertices @ Y_UP[:3, :3].T, "<f4"),
        "normals": _text(mesh.normals @ Y_UP[:3, :3].T, "<f4"),
        "faces": _text(mesh.faces, "<u4"),
        "colour": base_colour(material),
        "metallic": material.metallic,
        "roughness": material.roughness,
        "ior": material.one_eta if material.f0.eta else 1.5,
    }


def _text(values: np.ndarray, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values).astype(kind).tobytes()).decode("ascii")


if __name__ == "__main__":
    answer(draw)
