"""What the shaders are told of a surface."""

import numpy as np

from renderer.draw import Renderer
from renderer.precompute import precomputed
from renderer.techniques import technique
from reports.conformance.result import Conformance
from reports.run.conformance.shared import measured, uniforms_of
from scenes.schema import Case
from scenes.surface import plain


def of_surfaces(case: Case, name: str) -> list[Conformance]:
    """The uniforms of each object beside its material, relative to each: nothing is clamped."""
    how = technique(name).matched("unoccluded")  # what stands around is no part of a surface
    environment = precomputed(case.environment.path)
    environment.need(sorted({m for o in case.objects for m in how.maps(o.material, case.model)}))
    prepared = Renderer(how).prepare(case, environment.maps)
    found = []
    for obj, draw in zip(case.objects, prepared.draws, strict=True):
        for field, value in uniforms_of(plain(obj)).items():
            ours, theirs = np.array(draw.uniforms[field]), np.array(value)
            off = np.max(np.abs(ours - theirs) / np.maximum(np.abs(theirs), 1e-9))
            found.append(measured("surfaces", off, f"{field} of {obj.name} in {case.id}, {name}"))
    prepared.target.release()
    return found
