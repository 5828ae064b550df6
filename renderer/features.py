"""One table: each feature of the renderer, the maps it reads, and when a material needs it.

A lobe is compiled in only for the materials that have it; what a whole frame has, its technique
names (`renderer/techniques.py`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil

from scenes.schema import PAPER, VERTEX, Material, Model
from scenes.surface import has_direction


@dataclass(frozen=True)
class Feature:
    """A piece of shading that can be compiled in or left out.

    Attributes:
        name: as #defined in GLSL where the shader tests for it.
        needed: whether a material needs it.
        maps: the precomputed maps that it reads under the paper's split sum.
        tables: those of them that hold only under the paper's masking.
        split: those that it reads under the better one.
    """

    name: str
    needed: Callable[[Material], bool]
    maps: tuple[str, ...] = ()
    tables: tuple[str, ...] = ()
    split: tuple[str, ...] = ()


def _some_beckmann(m: Material) -> bool:
    return m.weight < 1 or m.maps.weight is not None


def some_diffuse(m: Material) -> bool:
    """Whether any of a material is a diffuse lobe."""
    return max(m.albedo) > 0 and _some_dielectric(m)


def _some_dielectric(m: Material) -> bool:
    return m.metallic < 1 or m.maps.metallic is not None


LOBES = (
    Feature(
        "D_GGX",
        lambda m: m.weight > 0,
        ("prefiltered_ggx",),
        ("table_ggx",),
        ("lobe_ggx", "albedo_ggx", "towards_ggx"),
    ),
    Feature(
        "D_BECKMANN",
        _some_beckmann,
        ("prefiltered_beckmann",),
        ("table_beckmann",),
        ("lobe_beckmann", "albedo_beckmann", "towards_beckmann"),
    ),
    Feature("G_GGX", lambda m: m.masking_weight > 0),
    Feature("G_BECKMANN", lambda m: m.masking_weight < 1 or _follows(m)),
    Feature("DIFFUSE", some_diffuse, ("irradiance_map",), split=("irradiance_exact",)),
)


def _follows(m: Material) -> bool:
    """Whether the weight in G varies with that in D."""
    return m.maps.weight is not None and m.weight_g is None


def _by_vertex(m: Material, *names: str) -> bool:
    return any(m.maps.given.get(n) == VERTEX for n in names)


# What a material with a direction or maps adds; see shaders/vary.glsl.
VARYING = (
    Feature("VARIES", lambda m: m.varies),
    Feature("DIRECTED", has_direction),
    Feature("TEXTURED", lambda m: bool(m.maps.pictures)),
    Feature("VERTEX_ALBEDO", lambda m: _by_vertex(m, "albedo")),
    Feature("VERTEX_NUMBERS", lambda m: _by_vertex(m, "roughness", "metallic", "weight")),
    Feature("MAP_ALBEDO", lambda m: "albedo" in m.maps.pictures),
    Feature("MAP_ROUGHNESS", lambda m: "roughness" in m.maps.pictures),
    Feature("MAP_METALLIC", lambda m: "metallic" in m.maps.pictures),
    Feature("MAP_WEIGHT", lambda m: "weight" in m.maps.pictures),
    Feature("MAP_NORMAL", lambda m: "normal" in m.maps.pictures),
    Feature("VARIES_WEIGHT", lambda m: m.maps.weight is not None),
    Feature("MASKING_FOLLOWS", _follows),
)

# What a model adds, by the material that needs it.
MODELS: dict[str, Callable[[Material, Model], bool]] = {
    "MASKING_SMITH": lambda _, model: model.masking == "smith",
    "FRESNEL_F82": lambda _, model: model.fresnel == "f82",
    "FRESNEL_METAL": lambda m, model: model.fresnel == "exact" and m.metallic > 0,
    "FRESNEL_DIELECTRIC": lambda m, model: model.fresnel == "exact" and _some_dielectric(m),
    "KD_INTERFACE": lambda m, model: model.kd == "interface" and some_diffuse(m),
    "KD_CONSERVING": lambda m, model: model.kd == "conserving" and some_diffuse(m),
    "MULTISCATTER": lambda _, model: model.multiscatter == "on",
}
LOST_LIGHT = {"KD_INTERFACE", "KD_CONSERVING", "MULTISCATTER"}  # these read a table


def features(
    material: Material, model: Model = PAPER, diffuse: bool = True, forced: tuple[str, ...] = ()
) -> frozenset[str]:
    """The names of the features that a material needs under a model, and of those forced."""
    needed = {f.name for f in LOBES + VARYING if f.needed(material)} | set(forced)
    needed |= {name for name, asked in MODELS.items() if asked(material, model)}
    if not diffuse:
        needed.add("SPECULAR_LIGHT")  # the lobe stays, or its share of the samples would go
    return frozenset(needed)


def split_samples(
    material: Material, samples: int, model: Model = PAPER, spared: bool = False
) -> tuple[int, int, int]:
    """Share samples out to the lobes (GGX, Beckmann, cosine).

    The diffuse lobe gets a share by its albedo against F0, between a fifth and a half: the
    balance heuristic keeps any split unbiased. Light that meets a second facet comes back from
    everywhere, as diffuse light does, and counts with it. Of 4 samples or more each needed lobe
    gets some; of fewer GGX goes before Beckmann, whose short tail would hardly ever find what GGX
    reflects. Of the cosine samples three in four may be `spared`.
    """
    diffuse = max(material.diffuse_albedo)
    share = 0.0
    if diffuse > 0 or model.multiscatter == "on":
        share = min(max(diffuse / max(diffuse + max(material.specular_f0), 1e-9), 0.2), 0.5)
    specular = samples - round(share * samples)
    ggx = round(material.weight * specular)
    if 0 < material.weight < 1:
        ggx = max(min(ggx, specular - 1), 1)
    cosine = samples - specular
    return ggx, specular - ggx, ceil(cosine / 4) if spared else cosine
