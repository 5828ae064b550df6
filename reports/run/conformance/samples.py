"""Where samples lie, and the density by which they are divided."""

import numpy as np

from renderer.features import features, split_samples
from renderer.probe import probe
from renderer.techniques import Technique
from reports.conformance.kernels import cumulated
from reports.conformance.result import Conformance
from reports.run.conformance.shared import MATERIAL, UNIFORMS, measured, uniforms_of
from reports.stability import oracle
from reports.stability.agreement import off_by, peaks
from reports.stability.directions import directions
from scenes.schema import Material


def of_samples(material: Material, how: Technique) -> list[Conformance]:
    """Where a technique's samples lie, and the density by which it divides."""
    index = np.arange(1024)
    found, u = [], oracle.hammersley(index, np.full(1024, 1024))
    ours = probe("vec4(hammersley(uint(i.x), 1024u), 0.0, 0.0)", {"i": index}, ("hammersley.glsl",))
    found.append(measured("samples", np.abs(ours[:, :2] - u).max(), "hammersley"))
    alpha = material.alpha
    for lobe in ("ggx", "beckmann", "cosine"):
        given = "u.xy" if lobe == "cosine" else f"u.xy, {alpha:.9g}"
        made = probe(f"vec4(sample_{lobe}({given}), 0.0)", {"u": u}, (f"sample_{lobe}.glsl",))
        made = made[:, :3].astype(float)
        length = np.linalg.norm(made, axis=1)
        # By sine and cosine, which do not jump where a turn is whole.
        phi = 2 * np.pi * u[:, 1]
        flat = np.hypot(made[:, 0], made[:, 1])
        offs = [
            length - 1,
            made[:, 0] - flat * np.cos(phi),
            made[:, 1] - flat * np.sin(phi),
        ]
        offs.append(cumulated(lobe, made[:, 2] / length, alpha) - u[:, 0])
        found.append(measured("samples", np.abs(offs).max(), f"sample_{lobe}, alpha {alpha:.3g}"))
    count = split_samples(material, how.per_pixel(material))
    wi, wo = directions(alpha)
    ours = probe(
        f"vec4(sample_density(wi.xyz, wo.xyz, {MATERIAL}, ivec3({', '.join(map(str, count))})))",
        {"wi": wi, "wo": wo},
        (how.shade,),
        features(material),
        uniforms_of(material),
        UNIFORMS,
    )[:, :1]
    theirs = oracle.sample_density(wi, wo, alpha, np.array(count))[:, None]
    off = off_by(ours, theirs, peaks(theirs, wo[:, 2]))
    found.append(measured("densities", off.max(), f"{material.name}, alpha {alpha:.3g}"))
    return found
