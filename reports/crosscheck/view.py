"""Put one linear picture through Blender's own view transforms; runs under a Python with bpy.

python -I view.py LINEAR.exr FOLDER EXPOSURE TRANSFORM ..., writing FOLDER/TRANSFORM.png.
"""

import sys
from pathlib import Path

import bpy


def main(linear: Path, folder: Path, exposure: float, transforms: list[str]) -> None:
    """No look, gamma 1, an sRGB screen; EXPOSURE in stops."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    image = bpy.data.images.load(str(linear))
    image.colorspace_settings.name = "Linear Rec.709"
    scene.display_settings.display_device = "sRGB"
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.color_depth = "16"
    scene.render.dither_intensity = 0
    scene.view_settings.look = "None"
    scene.view_settings.gamma = 1
    scene.view_settings.exposure = exposure
    for transform in transforms:
        scene.view_settings.view_transform = transform
        image.save_render(str(folder / f"{transform}.png"), scene=scene)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), float(sys.argv[3]), sys.argv[4:])
