"""Scale and bias for F0, beside the integral that they stand for."""

import numpy as np

from renderer.precompute import Precomputed, brdf_table
from reports.conformance.result import Conformance
from reports.conformance.split_sum import scale_bias, smith, vcavity
from reports.run.conformance.shared import measured, relative, texels_of
from scenes.schema import ALPHA_MIN, Material

PLACES = 16  # of a table that are looked at


def of_table(made: Precomputed, name: str) -> Conformance:
    """A table that all materials share, at some of its texels."""
    texels = texels_of(made.maps[name])
    size = brdf_table.SIZE
    rng = np.random.default_rng(5)
    columns = np.concatenate([rng.integers(8, size[0], PLACES - 1), [size[0] - 1]])
    rows = np.concatenate([[size[1] - 1], rng.integers(8, size[1], PLACES - 1)])
    weight = (0, 1) if "beckmann" in name else (1, 0)
    theirs = []
    for row, column in zip(rows, columns, strict=True):
        cosine, alpha = (column + 0.5) / size[0], max(((row + 0.5) / size[1]) ** 2, ALPHA_MIN)
        maskings = (smith(alpha), vcavity)
        theirs.append(np.concatenate([scale_bias(cosine, alpha, weight, m) for m in maskings]))
    return measured("tables", relative(texels[rows, columns], np.array(theirs)), name)


def of_own_table(material: Material) -> Conformance:
    """A material's own table under the masking `smith`."""
    (texels,) = texels_of(brdf_table.smith_table(material).texture)
    weight, weight_g = ((w, 1 - w) for w in (material.weight, material.masking_weight))
    masking = smith(material.alpha, weight_g)
    columns = range(8, len(texels), 29)
    theirs = [scale_bias((c + 0.5) / len(texels), material.alpha, weight, masking) for c in columns]
    off = relative(texels[list(columns), :2], np.array(theirs))
    return measured("tables", off, f"{material.name}'s own")
