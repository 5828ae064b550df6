"""The candidate command: case as JSON in, Cycles' picture of it out.

    python -m reports.crosscheck PYTHON CASE OUT [--samples N] [--seed N]

PYTHON is an interpreter that has bpy. The meshes and the environment are read here and handed
over as arrays, so that both path tracers draw the same numbers.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

from reports.crosscheck.export import write_scene
from scenes.errors import InputError
from scenes.files import read_json
from scenes.schema import Case

BLENDER = Path(__file__).with_name("blender.py")


def main() -> int:
    """Export, render, and pass on Cycles' exit code; 2 for a case that it cannot draw."""
    parser = argparse.ArgumentParser(prog="reports.crosscheck")
    parser.add_argument("python", help="an interpreter with bpy")
    parser.add_argument("case", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--samples", type=int, default=192, help="per pixel")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        try:
            write_scene(read_json(Case, options.case), Path(folder))
        except InputError as error:
            print(error, file=sys.stderr)
            return 2
        words = [folder, options.out, options.samples, options.seed]
        # -I: neither PYTHONPATH nor this folder may shadow Blender's own modules.
        return subprocess.run([options.python, "-I", BLENDER, *map(str, words)]).returncode


if __name__ == "__main__":
    sys.exit(main())
