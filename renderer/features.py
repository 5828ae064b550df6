"""One table: each feature of the renderer, the maps it reads, and when a material needs it.

A technique names the features of a whole frame; a lobe is compiled in only for the materials
that have it.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, replace

from scenes.schema import PAPER, Material, Model


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
        lambda m: m.weight < 1,
        ("prefiltered_beckmann",),
        ("table_beckmann",),
        ("lobe_beckmann", "albedo_beckmann", "towards_beckmann"),
    ),
    Feature("G_GGX", lambda m: m.masking_weight > 0),
    Feature("G_BECKMANN", lambda m: m.masking_weight < 1),
    Feature(
        "DIFFUSE",
        lambda m: max(m.diffuse_albedo) > 0,
        ("irradiance_map",),
        split=("irradiance_exact",),
    ),
)

# Mesa's llvmpipe ends the loops of a shader, silently, after 65,535 turns in all.
MOST_SAMPLES = 65_000

FINE = "_fine"  # ends the names of maps made much more finely than a technique would

# What the shaders can draw of a model. Truths cover all of it.
DRAWN = {
    "fresnel": ("schlick",),
    "kd": ("one-minus-fresnel",),
    "masking": ("paper", "smith"),
    "multiscatter": ("off",),
}


@dataclass(frozen=True)
class Technique:
    """How the renderer integrates a model over a whole frame.

    Attributes:
        shade: the shader file that integrates.
        samples: directions per pixel, where the shader samples; else 0. Coverage samples share
            them, and have at least one each.
        msaa: coverage samples per pixel, box-filtered; 0 for none.
        supersample: whole pixels drawn per pixel and axis, box-filtered.
        filtered: look each sample up in a mip as large as its share of directions; without,
            the result has no bias and all of the noise.
        diffuse: with the diffuse lobe's light; without, only the specular lobes' is left.
        fine: maps made so finely that their own error is gone, to tell it from others.
        forced: names of features compiled in whether a material needs them or not, to show what
            leaving them out saves and that it changes nothing.
        reads: maps that it reads whatever the material.
        split: whether it reads the maps of the better split sum.
    """

    name: str
    shade: str
    samples: int = 0
    msaa: int = 4
    supersample: int = 1
    filtered: bool = True
    diffuse: bool = True
    fine: tuple[str, ...] = ()
    forced: tuple[str, ...] = ()
    reads: tuple[str, ...] = ()
    split: bool = False

    @property
    def sets(self) -> int:
        """How many sets of directions a drawn pixel may have, one for each coverage sample."""
        return max(self.msaa, 1)

    @property
    def samples_per_set(self) -> int:
        """Directions in each of them."""
        return -(-self.samples // (self.supersample**2 * self.sets))

    def maps(self, material: Material, model: Model = PAPER) -> tuple[str, ...]:
        """The precomputed maps that this technique reads for a material, shared by all weights."""
        if self.samples:
            return self.reads
        read = [f for f in LOBES if f.needed(material) or f.name in self.forced]
        if self.split:
            return tuple(m for f in read for m in f.split)
        tables = () if self.own_table(model) else tuple(t for f in read for t in f.tables)
        names = tuple(m for f in read for m in f.maps) + tables
        return tuple(f"{n}{FINE}" if n in self.fine else n for n in names)

    def own_table(self, model: Model) -> bool:
        """Whether each material has a table of its own: `smith` is not linear in the weights."""
        return not self.samples and model.masking == "smith"

    def cannot_draw(self, model: Model) -> str:
        """What of a model this technique cannot draw, in one line; empty if it can draw all."""
        fields = [f for f, drawn in DRAWN.items() if getattr(model, f) not in drawn]
        return ", ".join(f"{f} = '{getattr(model, f)}'" for f in fields)


TECHNIQUES = {
    "paper": Technique("paper", "shade_paper.glsl"),
    "paper-noaa": Technique("paper-noaa", "shade_paper.glsl", msaa=0),
    "sampled": Technique("sampled", "shade_sampled.glsl", samples=96),
    "split": Technique("split", "shade_split.glsl", split=True),
    "filtered": Technique(
        "filtered", "shade_filtered.glsl", samples=64, reads=("blurred_map", "lights_map")
    ),
}


def technique(name: str) -> Technique:
    """A technique by name; `sampled@N` and `filtered@N` take N directions per pixel.

    Raises:
        ValueError: there is no such technique.
    """
    if found := TECHNIQUES.get(name):
        return found
    match = re.fullmatch(r"(sampled|filtered)@(\d{1,5})", name)
    if match and 0 < int(match[2]) <= MOST_SAMPLES:
        return replace(TECHNIQUES[match[1]], name=name, samples=int(match[2]))
    known = ", ".join([*TECHNIQUES, "sampled@N", "filtered@N"])
    raise ValueError(f"unknown technique '{name}'; known: {known} with N up to {MOST_SAMPLES}")


def switched(base: Technique, model: Model = PAPER) -> dict[str, Technique]:
    """A technique with single switches thrown, by what they tell apart.

    `specular` leaves out the diffuse lobe's light; under the split sum `irradiance map` and `table`
    are free of the error of that map (where `table` is shared by all materials).
    """
    thrown = {"specular": replace(base, diffuse=False)}
    if not base.samples and not base.split:
        thrown["irradiance map"] = replace(base, fine=("irradiance_map",))
        if not base.own_table(model):
            thrown["table"] = replace(base, fine=("table_ggx", "table_beckmann"))
    return thrown


def features(
    material: Material, model: Model = PAPER, diffuse: bool = True, forced: tuple[str, ...] = ()
) -> frozenset[str]:
    """The names of the features that a material needs under a model, and of those forced."""
    needed = {f.name for f in LOBES if f.needed(material)} | set(forced)
    if model.masking == "smith":
        needed.add("MASKING_SMITH")
    if not diffuse:
        needed.add("SPECULAR_LIGHT")  # the lobe stays, or its share of the samples would go
    return frozenset(needed)


def split_samples(material: Material, samples: int) -> tuple[int, int, int]:
    """Share samples out to the lobes (GGX, Beckmann, cosine).

    The diffuse lobe gets a share by its albedo against F0, between a fifth and a half: the
    balance heuristic keeps any split unbiased. Of 4 samples or more each needed lobe gets some; of
    fewer GGX goes before Beckmann, whose short tail would hardly ever find what GGX reflects.
    """
    diffuse = max(material.diffuse_albedo)
    share = 0.0
    if diffuse > 0:
        share = min(max(diffuse / (diffuse + max(material.specular_f0)), 0.2), 0.5)
    specular = samples - round(share * samples)
    ggx = round(material.weight * specular)
    if 0 < material.weight < 1:
        ggx = max(min(ggx, specular - 1), 1)
    return ggx, specular - ggx, samples - specular
