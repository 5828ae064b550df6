"""Integrals that are known: of D, and of both white furnaces, with the GLSL as integrand."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from renderer.features import features
from renderer.probe import probe
from reports.stability.directions import MASKINGS
from reports.stability.grid import ALPHAS, COSINES, JUDGED, ONE, WEIGHTS, axis
from reports.stability.maps import Shown, make_map
from reports.stability.promise import PLACED
from reports.stability.quadrature import facets
from reports.stability.results import Map
from scenes.schema import Material, Model

NORMALISED = 1e-4
WEAK = 1e-3
# 1, and what nodes misplaced by .3 % of alpha leave (3e-4; see PLACED); the nodes err by 2e-5.
WHITE = 1 + 1e-3
INTEGRAND = """vec4(D_mixture(h.xyz, alpha.x, weight),
    G_mixture(vec3(0.0, 0.0, 1.0), wo.xyz, h.xyz, h.w, alpha.x, weight),
    brdf(wi.xyz, wo.xyz, Material(vec3(0.0), vec3(1.0), alpha.x, weight, weight)).x, 0.0)"""


def furnaces(
    alphas: np.ndarray, cosines: np.ndarray, weight: float, masking: str
) -> dict[str, np.ndarray]:
    """The integrals of one mixture, each (cosines, alphas).

    - `normalised`: of D n.h over the hemisphere.
    - `weak_furnace`: of G1(wo) D max(wo.h, 0) / n.wo, the area of the facets that wo sees over
      the area that it should see (Heitz 2014, eq. 80). G1(wo) is the shader's G with n as the
      other direction, which no facet hides.
    - `white_furnace`: of f n.wi over light, with F = 1.
    """
    seen = [facets(float(a), float(c)) for c in cosines for a in alphas]
    counts = [len(s.h) for s in seen]
    h = np.concatenate([s.h for s in seen])
    wo_h = np.concatenate([s.wo_h for s in seen])
    wo = np.repeat([s.wo for s in seen], counts, axis=0)
    alpha = np.repeat(np.tile(alphas, len(cosines)), counts)
    wi = 2 * wo_h[:, None] * h - wo
    material = Material(roughness=1.0, metallic=1.0, metal=1.0, weight=weight)
    D, G1, f, _ = probe(
        INTEGRAND,
        {"h": np.column_stack([h, wo_h]), "wi": wi, "wo": wo, "alpha": alpha},
        ("brdf.glsl",),
        features(material, Model(masking=masking)),
        {"weight": (weight, 1 - weight)},
        "uniform vec2 weight;",
    ).T.astype(float)
    facing = np.maximum(wo_h, 0)
    terms = {
        "normalised": D * h[:, 2],
        "weak_furnace": D * G1 * facing / wo[:, 2],
        "white_furnace": np.where(wi[:, 2] > 0, f * wi[:, 2] * 4 * facing, 0),
    }
    omega = np.concatenate([s.omega for s in seen])
    starts = np.cumsum([0, *counts[:-1]])
    shape = (len(cosines), len(alphas))
    return {n: np.add.reduceat(t * omega, starts).reshape(shape) for n, t in terms.items()}


def maps(alphas: np.ndarray = ALPHAS[::2], cosines: np.ndarray = COSINES[::2]) -> Iterator[Map]:
    """NDFs normalised, and both furnaces, for both maskings; all are smooth in alpha and n.v."""
    across, down = axis("alpha", alphas, log=True), axis("n.v", cosines, log=True)
    slices = axis("weight", WEIGHTS)
    head_on = [furnaces(alphas, np.ones(1), w, "smith")["normalised"][0] for w in WEIGHTS]
    yield make_map(
        "D_mixture",
        "normalised",
        np.array(head_on)[None, :, :, None],
        (ONE, slices, across),
        lambda at: [{"alpha": alphas[at[2]], "weight": WEIGHTS[at[1]]}],
        name="normalised",
        why="The facets' area, projected on the plane that they make up, is that of the plane "
        "(Walter et al. 2007, eq. 4).",
        unit="integral of D n.h; 1 is right",
        at_least=1 - NORMALISED,
        limit=1 + NORMALISED,
    )
    for masking in MASKINGS:
        found = [furnaces(alphas, cosines, w, masking) for w in WEIGHTS]

        def reproduce(at, masking=masking) -> list[Shown]:
            cell = {"alpha": alphas[at[2]], "n.v": cosines[at[1]], "weight": WEIGHTS[at[0]]}
            return [cell | {"masking": masking}]

        yield make_map(
            "G_mixture",
            "weak white furnace",
            np.stack([f["weak_furnace"] for f in found])[..., None],
            (slices, down, across),
            reproduce,
            name="weak_furnace",
            masking=masking,
            unit="visible facets over what a direction should see; 1 is right",
            **_weak(masking),
        )
        yield make_map(
            "brdf",
            "white furnace",
            np.stack([f["white_furnace"] for f in found])[..., None],
            (slices, down, across),
            reproduce,
            name="white_furnace",
            masking=masking,
            why="Facets that reflect everything send back at most what comes, less what meets a "
            "second facet: claimed for the specular lobe with F = 1, under both maskings, and not "
            "for a white surface with kd = 1 - F, which may exceed 1.",
            unit="share of uniform light sent back; at most 1",
            tried=np.outer(cosines, alphas) >= PLACED * (1 - 1e-6),
            at_least=0.0,
            limit=WHITE,
            centre=0.0,
        )


def _weak(masking: str) -> dict[str, Any]:
    """What must hold of the weak furnace, and how well."""
    if masking == "paper":
        why = "The paper's mean of maskings is not that of the mixed facets: reported as it is."
        return {"why": why, "judged": JUDGED, "centre": 1.0}
    why = "Smith's masking is the one that shows each direction just the facets that it should see."
    return {"why": why, "at_least": 1 - WEAK, "limit": 1 + WEAK}
