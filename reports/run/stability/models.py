"""The whole BRDF under every other model: against float64, Mitsuba, itself reversed, and furnaces.

The surface is part copper over coloured acrylic, so that every term and channel counts.
"""

from collections.abc import Iterator

import numpy as np

import reference.probe as reference
from renderer.probe import brdf_values
from reports.run.stability.brdf import RECIPROCAL
from reports.stability.agreement import TOLERANCE
from reports.stability.grid import COSINE, COSINES, JUDGED, PER_CELL, axis, pairs
from reports.stability.maps import SCALE, Shown, difference, make_map
from reports.stability.models import model_brdf
from reports.stability.quadrature import facets
from reports.stability.results import Map
from scenes.schema import PHYSICAL, Material, Model

MODELS = {
    "f82": Model(fresnel="f82"),
    "exact": Model(fresnel="exact"),
    "conserving, compensated": Model(fresnel="exact", kd="conserving", multiscatter="on"),
    "the same, masking smith": Model(
        fresnel="exact", kd="conserving", masking="smith", multiscatter="on"
    ),
    "physical": PHYSICAL,
}
WIDTHS = np.array([0.01, 0.1, 1.0])
METALLIC = axis("metallic", [0.0, 0.4])
# Mitsuba integrates the transmittance of `roughplastic` by 32 x 32 nodes, with a fit for
# Beckmann's masking that is .35 % off, and reads it linearly between 64 cosines: in the lowest
# interval, where that of alpha .01 turns, it is 9.5 % off, and 2e-3 from n.w = .02 and alpha .1 on.
INTERFACE = 0.1
WHITE = 1e-3  # of a white furnace that gives back all


def surface(alpha: float, weight: float, metallic: float) -> Material:
    """Part copper over coloured acrylic."""
    return Material(
        albedo=(0.6, 0.3, 0.05),
        roughness=alpha**0.5,
        metallic=metallic,
        f0="acrylic",
        metal="Cu",
        weight=weight,
    )


def evaluated(
    material: Material, model: Model, wi: np.ndarray, wo: np.ndarray
) -> tuple[np.ndarray, ...]:
    """f without the cosine by GLSL, float64 and Mitsuba, (n, 3) each."""
    ours = brdf_values(material, wi, wo, model)
    theirs = reference.brdf_values(material, wi, wo, model)
    return ours, model_brdf(material, wi, wo, model), theirs


def beside_mitsuba(model: Model) -> float:
    """How far GLSL may be from Mitsuba."""
    return INTERFACE if model.kd == "interface" else TOLERANCE


def maps() -> Iterator[Map]:
    """Every model's agreement and reciprocity; and the furnace of what must keep all light."""
    for name, model in MODELS.items():
        yield from agreements(name, model)
    yield white_furnace()


def agreements(name: str, model: Model, widths: np.ndarray = WIDTHS) -> Iterator[Map]:
    """GLSL beside float64, Mitsuba and itself reversed, over metallic, n.v and alpha."""
    _, wi, wo = pairs(widths)
    cells = (len(COSINES), len(widths))
    rows = np.arange(len(wi)).reshape(*cells, PER_CELL)
    figures = np.zeros((3, len(METALLIC.values), *cells, PER_CELL))
    for k, metallic in enumerate(METALLIC.values):
        f, back = np.zeros((3, len(wi), 3)), np.zeros((len(wi), 3))
        for column, alpha in enumerate(widths):
            own, material = rows[:, column].ravel(), surface(alpha, 0.5, metallic)
            f[:, own] = evaluated(material, model, wi[own], wo[own])
            back[own] = brdf_values(material, wo[own], wi[own], model)
        ours, truth, theirs = f
        figures[:, k] = [difference(ours, other, cells) for other in (truth, theirs, back)]

    def reproduce(at) -> list[Shown]:
        row = rows[at[1:]]
        switches = model.model_dump()
        shown = {"alpha": widths[at[2]], "weight": 0.5, "metallic": METALLIC.values[at[0]]}
        return [shown | {"wi": wi[row], "wo": wo[row]} | switches]

    limits = (TOLERANCE, beside_mitsuba(model), RECIPROCAL)
    whys = (
        "The same model from the same float32 directions; its integrals by another quadrature.",
        "Candidate and truth draw one model, each with integrals of its own.",
        "f(wi, wo) = f(wo, wi): every term is of h, or a product of one factor for each direction.",
    )
    told = ("against float64", "against Mitsuba", "reciprocal")
    for invariant, figure, limit, why in zip(told, figures, limits, whys, strict=True):
        yield make_map(
            "model",
            f"{name}, {invariant}",
            figure,
            (METALLIC, COSINE, axis("alpha", widths, log=True)),
            reproduce,
            why=why,
            unit=SCALE,
            limit=limit,
            judged=JUDGED,
        )


def white_furnace(widths: np.ndarray = WIDTHS) -> Map:
    """What a white metal, and a white plastic, give back of even light under masking smith."""
    model = MODELS["the same, masking smith"].model_copy(update={"fresnel": "schlick"})
    cosines = COSINES[6:]
    surfaces = {
        "metal": lambda alpha: Material(roughness=alpha**0.5, metallic=1, metal=1.0, weight=0.5),
        "plastic": lambda alpha: Material(
            albedo=(1, 1, 1), roughness=alpha**0.5, metallic=0, weight=0.5
        ),
    }
    figures = np.array(
        [
            [[sent_back(make(a), c, model) for a in widths] for c in cosines]
            for make in surfaces.values()
        ]
    )
    return make_map(
        "white furnace",
        "all light comes back",
        figures[..., None],
        (
            axis("metal, plastic", [0, 1]),
            axis("n.v", cosines, log=True),
            axis("alpha", widths, log=True),
        ),
        lambda at: [{"alpha": widths[at[2]], "n.v": cosines[at[1]]}],
        name="white_furnace",
        why="With facets compensated F = 1 loses nothing, nor does a white diffuse lobe.",
        unit="share of uniform light sent back; 1 is right",
        at_least=1 - WHITE,
        limit=1 + WHITE,
    )


def sent_back(material: Material, cosine: float, model: Model) -> float:
    """The share of even light that GLSL sends back, the worst channel's.

    The specular lobe by nodes where it is, the rest by nodes over the hemisphere.
    """
    seen = facets(material.alpha, cosine)
    wi = 2 * seen.wo_h[:, None] * seen.h - seen.wo
    lit = (seen.wo_h > 0) & (wi[:, 2] > 0)
    wi, measure = wi[lit], (4 * seen.wo_h * seen.omega)[lit]
    bare = material.model_copy(update={"albedo": (0.0, 0.0, 0.0)})
    single = model.model_copy(update={"multiscatter": "off"})
    lobe = brdf_values(bare, wi, _all(seen.wo, wi), single)
    total = (measure * wi[:, 2]) @ lobe
    x, w = np.polynomial.legendre.leggauss(200)
    mu, w = ((x + 1) / 2) ** 2, w / 2 * (x + 1)  # more where light grazes
    even = np.stack([np.sqrt(1 - mu**2), 0 * mu, mu], axis=1)
    eye = _all(seen.wo, even)
    wide = brdf_values(material, even, eye, model) - brdf_values(bare, even, eye, single)
    total = total + 2 * np.pi * (w * mu) @ wide
    return float(total[np.abs(total - 1).argmax()])


def _all(one: np.ndarray, like: np.ndarray) -> np.ndarray:
    return np.broadcast_to(one, like.shape).astype(np.float32)
