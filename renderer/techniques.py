"""Techniques: how a whole frame is drawn, by name, and without which of their ideas."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import ceil
from typing import Any

from renderer.features import LOBES, LOST_LIGHT, features, some_diffuse
from scenes.schema import PAPER, Material, Model
from scenes.surface import has_direction

# Mesa's llvmpipe ends the loops of a shader, silently, after 65,535 turns in all.
MOST_SAMPLES = 65_000

GROUP = 4  # coverage samples, or groups of them, that may share a shading point
MOST_POINTS = GROUP**3  # shading points of a pixel

# Lobes narrower than this, in alpha, are traced: what is baked has cells of .11 radians.
TRACED = 0.1
# Rays a pixel for the widest of them; narrower ones need fewer, but one for each coverage sample
# up to so many: where a pixel holds many triangles, it holds much of what they mirror.
RAYS, FEWEST_RAYS = 64, 32
# Wider ones than this read the mean of much of what is baked.
SEEN_FINELY = 0.4
# Rays of one pass: each may visit hundreds of nodes, and of all loops' turns there are 65,535.
PASS_RAYS = 16

FINE = "_fine"  # ends the names of maps made much more finely than a technique would

# What the split sum can draw of a model: its table is of Schlick's F, with the paper's kd. Samples
# of the BRDF itself draw all of it.
SPLIT_SUM_DRAWS = {
    "fresnel": ("schlick",),
    "kd": ("one-minus-fresnel",),
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
        grid: into how many parts per axis a pixel may be divided, with `msaa` coverage samples
            each, where triangles are smaller than pixels; a power of 2.
        supersample: whole pixels drawn per pixel and axis, box-filtered.
        occlusion: what stands in the light's way is baked at vertices and takes it away.
        interreflection: and sends its own light instead, baked there too.
        filtered: look each sample up in a mip as large as its share of directions; without,
            the result has no bias and all of the noise.
        diffuse: with the diffuse lobe's light; without, only the specular lobes' is left.
        even: what an even lobe reflects is known beforehand; without, it is sampled.
        shares: coverage samples of like normals share a shading point.
        rays: narrow lobes trace them; without, they read what is baked, as wide ones do.
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
    grid: int = 1
    supersample: int = 1
    occlusion: bool = False
    interreflection: bool = False
    filtered: bool = True
    diffuse: bool = True
    even: bool = True
    shares: bool = True
    rays: bool = True
    fine: tuple[str, ...] = ()
    forced: tuple[str, ...] = ()
    reads: tuple[str, ...] = ()
    split: bool = False

    def matched(self, truth: str) -> Technique:
        """This technique with what a truth leaves out switched off."""
        light = truth not in ("unoccluded", "direct")
        return replace(
            self,
            occlusion=self.occlusion and truth != "unoccluded",
            interreflection=self.interreflection and light,
        )

    def incoming(self, material: Material) -> str:
        """The shader file that says what light comes from a direction; incoming.glsl if empty."""
        if not self.occlusion:
            return ""
        return "incoming_traced.glsl" if self.traces(material) else "incoming_baked.glsl"

    def traces(self, material: Material) -> bool:
        """Whether rays are traced for a material, where others read what is baked."""
        return self.occlusion and self.rays and material.alpha < TRACED

    def looks_finely(self, material: Material) -> bool:
        """Whether what is baked is seen through a lobe so narrow that it must be exact."""
        return not self.traces(material) and material.alpha < SEEN_FINELY

    def per_point(self, material: Material, points: int) -> int:
        """Directions of a material at each of so many shading points of a drawn pixel."""
        samples, least = self.samples, 1
        if self.traces(material):
            asked = max(RAYS * (material.alpha / TRACED) ** 2, min(self.points, FEWEST_RAYS))
            samples = min(samples, asked, PASS_RAYS * self.points)
            # Of fewer `split_samples` leaves the diffuse lobe none.
            least = 4 if some_diffuse(material) else 1
        return max(ceil(samples / (self.supersample**2 * points)), least)

    def per_set(self, material: Material) -> int:
        """The same where each coverage sample is a shading point."""
        return self.per_point(material, self.coverage)

    def per_pixel(self, material: Material) -> int:
        """The same where one stands for all of them."""
        return self.per_set(material) * self.coverage

    def least_points(self, material: Material) -> int:
        """Shading points that a drawn pixel has at least: a pass cannot hold all rays of one."""
        points = 1 if self.shares else self.points
        while self.traces(material) and self.per_point(material, points) > PASS_RAYS:
            points *= GROUP
        return points

    def turns(self, material: Material) -> int:
        """In how many passes the shading points of a pixel are shaded; a power of 2."""
        if not self.traces(material):
            return 1
        in_one = max(PASS_RAYS // self.per_point(material, self.points), 1)
        return max(self.points // (1 << in_one.bit_length() - 1), 1)

    @property
    def coverage(self) -> int:
        """Coverage samples of a drawn pixel."""
        return max(self.msaa, 1) * self.grid**2

    @property
    def points(self) -> int:
        """How many shading points a drawn pixel may have."""
        return min(self.coverage, MOST_POINTS)

    @property
    def grouped(self) -> bool:
        """Whether coverage samples may share shading points by fours."""
        return self.shade == "shade_filtered.glsl" and self.msaa == GROUP

    def spares(self, material: Material, model: Model = PAPER) -> bool:
        """Whether most of what a material reflects diffusely is known before it is sampled: E(n) of
        an even lobe. A map's normals are not those that a vertex was lit with."""
        known = self.even and self.grouped
        return known and material.maps.normal is None and model.multiscatter == "off"

    def maps(self, material: Material, model: Model = PAPER) -> tuple[str, ...]:
        """The precomputed maps that this technique reads for a material, shared by all weights."""
        if self.samples:
            even = self.reads and some_diffuse(material)
            return self.reads + (("irradiance_sky",) if even else ())
        read = [f for f in LOBES if f.needed(material) or f.name in self.forced]
        if self.split:
            return tuple(m for f in read for m in f.split)
        tables = () if self.own_table(model) else tuple(t for f in read for t in f.tables)
        names = tuple(m for f in read for m in f.maps) + tables
        return tuple(f"{n}{FINE}" if n in self.fine else n for n in names)

    def own_table(self, model: Model) -> bool:
        """Whether each material has a table of its own: `smith` is not linear in the weights."""
        return not self.samples and model.masking == "smith"

    def cannot_draw(self, model: Model, materials: Iterable[Material] = ()) -> str:
        """What of a model and materials it cannot draw, in one line; empty if it can draw all."""
        draws = {} if self.samples else SPLIT_SUM_DRAWS
        fields = [f for f, drawn in draws.items() if getattr(model, f) not in drawn]
        told = [f"{f} = '{getattr(model, f)}'" for f in fields]
        varying = [m for m in materials if m.varies]
        if not self.samples:
            # Its maps are of round lobes; tables under `smith`, and `split`'s, of one width each.
            told += ["anisotropy"] * any(m.anisotropy != 0 for m in varying)
            one_width = self.own_table(model) or self.split
            told += ["maps with this masking"] * (one_width and any(m.maps.given for m in varying))
        elif any(features(m, model) & LOST_LIGHT for m in varying):
            told.append("anisotropy or maps with this kd or multiscatter")
        return ", ".join(told)

    def features(self, material: Material, model: Model = PAPER) -> frozenset[str]:
        """The names of the features that a material needs, and of those forced."""
        needed = features(material, model, self.diffuse, self.forced)
        if not self.even:
            needed |= {"SAMPLED_DIFFUSE"}
        # A normal map's variance has a direction, which only samples can follow.
        return needed | ({"ANISOTROPIC"} if self.samples and has_direction(material) else set())


LIT = ("blurred_map", "lights_map")  # the environment and its lights, apart

TECHNIQUES = {
    "paper": Technique("paper", "shade_paper.glsl"),
    "paper-noaa": Technique("paper-noaa", "shade_paper.glsl", msaa=0),
    "sampled": Technique("sampled", "shade_sampled.glsl", samples=96),
    "split": Technique("split", "shade_split.glsl", split=True),
    "filtered": Technique("filtered", "shade_filtered.glsl", samples=64, grid=4, reads=LIT),
    "shadowed": Technique(
        "shadowed", "shade_filtered.glsl", samples=64, grid=4, reads=LIT, occlusion=True
    ),
    "best": Technique(
        "best",
        "shade_filtered.glsl",
        samples=64,
        grid=4,
        reads=LIT,
        occlusion=True,
        interreflection=True,
    ),
}


# What a technique can be drawn without, which tells what each idea of it gains and costs.
WITHOUT: dict[str, dict[str, Any]] = {
    "antialiasing": {"msaa": 0, "grid": 1},
    "grid": {"grid": 1},
    "sharing": {"shares": False},
    "blur": {"filtered": False},
    "irradiance": {"even": False},
    "rays": {"rays": False},
    "interreflection": {"interreflection": False},
    "occlusion": {"occlusion": False, "interreflection": False},
}
BY_COUNT = tuple(n for n, t in TECHNIQUES.items() if t.samples)  # that take any number of samples


def technique(name: str) -> Technique:
    """A technique by name; `best@N` takes N directions per pixel, `best-without-rays` no rays.

    Raises:
        ValueError: there is no such technique, or it does without that anyway.
    """
    if found := TECHNIQUES.get(name):
        return found
    whole, apart, idea = name.rpartition("-without-")
    if apart:
        return _without(technique(whole), idea, name)
    match = re.fullmatch(rf"({'|'.join(BY_COUNT)})@(\d{{1,5}})", name)
    if match and 0 < int(match[2]) <= MOST_SAMPLES:
        return replace(TECHNIQUES[match[1]], name=name, samples=int(match[2]))
    known = ", ".join([*TECHNIQUES, *(f"{n}@N" for n in BY_COUNT)])
    raise ValueError(f"unknown technique '{name}'; known: {known} with N up to {MOST_SAMPLES}")


def _without(base: Technique, idea: str, name: str) -> Technique:
    """A technique without one of its ideas, a key of WITHOUT."""
    less = replace(base, **WITHOUT.get(idea, {}))
    filtered = base.grouped or idea not in ("sharing", "blur", "irradiance")
    sends_rays = base.occlusion or idea != "rays"
    if less == base or not filtered or not sends_rays:
        known = ", ".join(WITHOUT)
        raise ValueError(f"'{base.name}' has no '{idea}' to be without; some have {known}")
    return replace(less, name=name)


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
