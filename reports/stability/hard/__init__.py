"""Hard frames: inputs that are known to break renderers, each with what must hold and why.

Rows stand by kind, one file each; reports.run.stability.frames draws them with every technique.
"""

from functools import cache

from reports.stability.hard import images, light, materials, meshes
from reports.stability.hard.case import Hard


@cache
def hard_cases() -> dict[str, Hard]:
    """All hard cases by name."""
    rows = [*light.rows(), *meshes.rows(), *images.rows(), *materials.rows()]
    return {row.name: row for row in rows}
