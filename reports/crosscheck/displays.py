"""How red an object looks by the display transform alone: one linear frame, several displays.

    python -m reports.crosscheck.displays PYTHON FRAME.exr PICTURE.png [--object 1]

PYTHON has bpy, FRAME is one that shadeproof saved (it holds the ids of the objects), for example
`truths/<case>/physical.a.exr` of a finished run. Prints a table, and writes the object once per
display, side by side. Before any of them the object's median luminance is put at 0.18.
"""

import argparse
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from PIL import Image
from skimage.color import rgb2lab

from reports.display import LUMINANCE, display, exposure_for
from reports.metrics.subject import crop_of
from scenes.environment import read_pixels
from scenes.frame import load_frame

VIEW = Path(__file__).with_name("view.py")
BLENDERS = ("Standard", "Filmic", "AgX")  # Standard is the plain sRGB curve


def blender_views(python: str, rgb: np.ndarray) -> dict[str, np.ndarray]:
    """The picture under each of Blender's view transforms, (H, W, 3) display values in [0, 1]."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        linear = oiio.ImageBuf(np.ascontiguousarray(rgb, np.float32))
        linear.write(str(folder / "linear.exr"), oiio.FLOAT)
        words = [python, "-I", VIEW, folder / "linear.exr", folder, 0, *BLENDERS]
        subprocess.run([str(w) for w in words], check=True, stdout=subprocess.DEVNULL)
        return {b: read_pixels(folder / f"{b}.png", "view") for b in BLENDERS}


def reinhard(rgb: np.ndarray) -> np.ndarray:
    """x / (1 + x) per channel (Reinhard et al. 2002, eq. 3) and gamma 2.2, as tutorials have it."""
    return (rgb / (1 + rgb)) ** (1 / 2.2)


def colourfulness(shown: np.ndarray) -> dict[str, float]:
    """Of display values (p, 3): mean luminance of the screen, CIELAB chroma, HSV saturation."""
    linear = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    chroma = np.hypot(*rgb2lab(shown)[:, 1:].T)
    high, low = shown.max(axis=1), shown.min(axis=1)
    saturation = (high - low) / np.maximum(high, 1e-6)
    return {
        "luminance": float((linear @ LUMINANCE).mean()),
        "chroma": float(chroma.mean()),
        "chroma, median": float(np.median(chroma)),
        "saturation": float(saturation.mean()),
        "saturation, median": float(np.median(saturation)),
    }


def main() -> None:
    """Print the table as Markdown and write the strip of pictures."""
    parser = argparse.ArgumentParser(prog="reports.crosscheck.displays")
    parser.add_argument("python")
    parser.add_argument("frame", type=Path)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--object", type=int, default=1)
    options = parser.parse_args()
    frame = load_frame(options.frame)
    mask = frame.ids == options.object
    rgb = frame.rgb * exposure_for(frame.rgb, mask)
    views = blender_views(options.python, rgb)
    if (gap := abs(views["Standard"] - display(rgb, 1)).max()) > 1e-3:
        raise SystemExit(f"Blender's Standard is not our own display: off by {gap:.4f}")
    views["Reinhard"] = reinhard(rgb)
    crop = crop_of(mask)
    strip = np.concatenate([v[crop] for v in views.values()], axis=1)
    Image.fromarray(np.round(strip * 255).astype(np.uint8)).save(options.picture, optimize=True)
    figures = {name: colourfulness(view[mask]) for name, view in views.items()}
    print("| display |", " | ".join(figures["Standard"]), "|")
    print("| --- |", " | ".join("---:" for _ in figures["Standard"]), "|")
    for name, row in figures.items():
        print(f"| {name} |", " | ".join(f"{v:.3f}" for v in row.values()), "|")


if __name__ == "__main__":
    main()
