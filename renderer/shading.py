"""How a technique shades the materials of a case: programs, and what they are told."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import moderngl
import numpy as np

from renderer.context import context
from renderer.features import LOST_LIGHT, features, split_samples
from renderer.precompute import texture
from renderer.precompute.brdf_table import smith_table
from renderer.precompute.lost_light import LostLight, lost_light
from renderer.precompute.prefilter import LEVELS
from renderer.precompute.split import LAYERS
from renderer.program import Maps, program
from renderer.surface import material_rows, surface_uniforms, varying_uniforms
from renderer.techniques import FINE, GROUP, Technique
from scenes.schema import Case, Material, Object
from scenes.surface import finest_alpha, plain

INTERREFLECTION = frozenset({"INTERREFLECTION"})


@dataclass(frozen=True, eq=False)
class Shading:
    """A technique and the materials that it shades.

    Attributes:
        lit: whether lights are shaded apart from the environment.
    """

    technique: Technique
    case: Case
    lit: bool = False

    @cached_property
    def lost(self) -> list[LostLight | None]:
        """Of each object what its specular lobe does not send back, where the model asks."""
        model = self.case.model
        return [
            lost_light(m, model) if features(m, model) & LOST_LIGHT else None
            for m in map(plain, self.case.objects)
        ]

    @property
    def seconds(self) -> float:
        """What the tables of the materials took to make."""
        own = {lost for lost in self.lost if lost}
        if self.technique.own_table(self.case.model):
            own |= {smith_table(plain(o)) for o in self.case.objects}
        return sum(table.seconds for table in own)

    @property
    def any_material(self) -> frozenset[str]:
        """The features that any of the materials needs, for what reflects or lights others."""
        each = (self._features(plain(o)) for o in self.case.objects)
        among = INTERREFLECTION if self.technique.interreflection else frozenset[str]()
        return among.union(*each)

    def program(self, obj: Object, sides: frozenset[str]) -> moderngl.Program:
        """The program surface_shade.frag for an object; `sides` are features of the target."""
        how, material = self.technique, plain(obj)
        defines = self._features(obj.material) | frozenset(how.forced) | sides
        if obj.material.varies and texture.paired(obj):
            defines |= {"PAIRED"}
        if how.grouped:
            defines |= {"GROUPED"}
        if how.interreflection:
            defines |= self.any_material if how.traces(material) else INTERREFLECTION
        incoming = how.incoming(material)
        return program("fullscreen.vert", "surface_shade.frag", defines, how.shade, incoming)

    def turns(self, obj: Object) -> int:
        """In how many passes the shading points of an object's pixels are shaded."""
        return self.technique.turns(plain(obj))

    def uniforms(self, obj: Object) -> dict[str, Any]:
        """What the program is told of an object's surface."""
        how, material, model = self.technique, plain(obj), self.case.model
        index = self.case.index(obj.name) - 1
        own = {"drawn_row": (index + 0.5) / len(self.case.objects)}
        own["finest_alpha"] = finest_alpha(obj)
        if obj.material.varies:
            directed = "ANISOTROPIC" in self._features(obj.material)
            own |= varying_uniforms(obj.material, directed)
        counts = [how.per_point(material, GROUP**k) for k in range(4)]
        spared = how.spares(obj.material, model)
        shares = [split_samples(material, count, model, spared) for count in counts]
        if lost := self.lost[index]:
            own["multiscatter"] = lost.multiscatter
        return (
            own
            | surface_uniforms(material, model)
            | {
                "light_sharers": how.supersample**2 if how.filtered else 1e9,
                "pixel_samples": split_samples(material, how.per_pixel(material), model),
                "set_samples": split_samples(material, how.per_set(material), model),
                "specular_samples": tuple(ggx + beckmann for ggx, beckmann, _ in shares),
                "cosine_samples": tuple(cosine for *_, cosine in shares),
                "least_points": how.least_points(material),
                "most_points": how.points,
                "prefilter_levels": float(LEVELS),
                "lobe_layers": float(LAYERS),
                "coverage_samples": how.coverage if how.msaa else 0,
                "part_samples": how.msaa,
            }
        )

    def maps(self, obj: Object, maps: Maps) -> Maps:
        """The maps that shading an object reads, its own and out of all that there are."""
        how = self.technique
        if obj.material.varies:
            maps = maps | texture.make(obj)
        if how.own_table(self.case.model):
            maps = maps | {"table_smith": smith_table(plain(obj)).texture}
        return maps | {n: maps[f"{n}{FINE}"] for n in how.fine if f"{n}{FINE}" in maps}

    @cached_property
    def material_maps(self) -> Maps:
        """`materials`, a row an object, for what reflects any of them, and their `lost_light`."""
        made, count = {}, len(self.case.objects)
        if self.technique.interreflection:
            back = [lost.multiscatter if lost else (0.0,) * 3 for lost in self.lost]
            told = [plain(o) for o in self.case.objects]
            pairs = zip(told, back, strict=True)
            rows = np.stack([material_rows(m, self.case.model, b) for m, b in pairs])
            size = (rows.shape[1], count)
            made["materials"] = context().texture(size, 4, rows.tobytes(), dtype="f4")
        if any(self.lost):
            rows = [lost.texture.read() if lost else None for lost in self.lost]
            size = next(lost.texture.size for lost in self.lost if lost)
            nothing = bytes(len(next(r for r in rows if r)))
            data = b"".join(r or nothing for r in rows)
            made["lost_light"] = context().texture((size[0], count), 4, data, dtype="f4")
            made["lost_light"].filter = (moderngl.LINEAR, moderngl.LINEAR)
            made["lost_light"].repeat_x = made["lost_light"].repeat_y = False
        return made

    def _features(self, material: Material) -> frozenset[str]:
        how = self.technique
        defines = replace(how, forced=()).features(material, self.case.model)
        return defines | {"LIGHTS"} if self.lit else defines
