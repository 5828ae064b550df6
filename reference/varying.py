"""The case's model where it has a direction or varies over the surface, the plugin `varying`.

It takes the parameters of `mixture`, of which `albedo`, `weight`, `weight_g` and `metallic` are
what the maps are multiplied by, and instead of `alpha` and `f0`

| parameter                  | type    | meaning                                               |
| -------------------------- | ------- | ----------------------------------------------------- |
| `roughness`                | real    | perceptual, times its map                             |
| `stretch_x`, `stretch_y`   | reals   | alpha_x and alpha_y over roughness²                   |
| `rotation`                 | real    | of the tangent about the normal, in radians           |
| `directed`                 | boolean | the mesh has `vertex_tangent` and `vertex_side`       |
| `follows`                  | boolean | `weight_g` is the weight in D, with its map           |
| `f0`, `metal_f0`           | 3 reals | `schlick`, `f82`: of the dielectric and the metal     |
| `f82`, `metal_f82`         | 3 reals | `f82`: the same                                       |
| `NAME_map`                 | texture | factor of albedo, roughness, metallic or weight       |
| `normal_map`               | texture | slopes of the normal, see scenes.texture              |

Textures are bilinear and not filtered: paths integrate over the pixel.

With n the interpolated normal and t the interpolated tangent made perpendicular to it, slopes
(x, y) turn n to n' = (x t + y side cross(n, t) + n) normalised. The lobes stand about n' and lie
along t, made perpendicular to n' and turned by `rotation`. A surface is seen from where both n and
n' face; light counts where n' faces.
"""

from inspect import isfunction
from types import SimpleNamespace

import drjit as dr

import reference.anisotropic
from reference.mixture import Mixture
from reference.variant import mitsuba
from scenes.schema import ALPHA_MIN

mi = mitsuba()

MAPPED = ("albedo", "roughness", "metallic", "weight", "normal")


class Varying(Mixture):
    """The plugin: finds its parameters and frame at a point, and asks the formula there."""

    facets = reference.anisotropic

    def __init__(self, props: mi.Properties) -> None:
        ends = {name: float(props[name]) for name in ("weight", "weight_g", "metallic")}
        super().__init__(props)
        self.maps = {n: props[f"{n}_map"] for n in MAPPED if f"{n}_map" in props}
        self.follows, self.directed = bool(props["follows"]), bool(props["directed"])
        self.base = {
            "roughness": mi.Float(float(props["roughness"])),
            "stretch": mi.Vector2f(float(props["stretch_x"]), float(props["stretch_y"])),
            "turn": mi.Vector2f(*(f(float(props["rotation"])) for f in (dr.cos, dr.sin))),
            "metal_share": mi.Float(ends["metallic"]),
        }
        for name in ("f0", "f82"):
            if f"metal_{name}" in props:
                self.base[name] = mi.Color3f(list(props[f"metal_{name}"]))
        dr.make_opaque(*self.base.values())
        if "weight" in self.maps:
            self.has["beckmann"] = True
            self.has["masking_beckmann"] |= self.follows
        if "metallic" in self.maps and self.fresnel == "exact" and not self.has["dielectric"]:
            self.has["dielectric"] = True
            self.eta = mi.Float(float(props["eta"]))

    def eval_pdf(self, ctx, si, wo, active=True):
        here, frame, active = self._here(si, active)
        local = SimpleNamespace(wi=frame.to_local(si.wi))
        return here.eval_pdf(ctx, local, frame.to_local(wo), active)

    def sample(self, ctx, si, sample1, sample2, active=True):
        here, frame, active = self._here(si, active)
        local = SimpleNamespace(wi=frame.to_local(si.wi))
        bs, weight = here.sample(ctx, local, sample1, sample2, active)
        bs.wo = frame.to_world(bs.wo)
        return bs, weight

    def _here(self, si, active):
        """The formula with the parameters at a point, its frame in that of `si`, and who faces."""
        active = active & (si.wi.z > 0)
        single = [n for n in ("roughness", "metallic", "weight") if n in self.maps]
        values = {name: self.maps[name].eval_1(si, active) for name in single}
        roughness = self.base["roughness"] * values.get("roughness", 1)
        metallic = self.base["metal_share"] * values.get("metallic", 1)
        alpha = dr.maximum(dr.square(roughness) * self.base["stretch"], ALPHA_MIN)
        albedo = self.albedo
        if "albedo" in self.maps:
            albedo = albedo * self.maps["albedo"].eval_3(si, active)
        found = {"alpha": alpha, "albedo": albedo * (1 - metallic), "metallic": metallic}
        if "weight" in values:
            weight = self.weight * values["weight"]
            found |= {"weight": weight, "rest": 1 - weight}
            if self.follows:
                found |= {"weight_g": weight, "rest_g": 1 - weight}
        for name in ("f0", "f82"):
            if name in self.base:
                found[name] = getattr(self, name) * (1 - metallic) + self.base[name] * metallic
        return _Here(self, found), self._frame(si, active), active

    def _frame(self, si, active):
        n = mi.Normal3f(0, 0, 1)
        t = mi.Vector3f(1, 0, 0)
        if self.directed:
            t = si.to_local(mi.Vector3f(si.shape.eval_attribute_3("vertex_tangent", si, active)))
        length = dr.hypot(t.x, t.y)
        t = dr.select(length > 1e-6, mi.Vector3f(t.x, t.y, 0) / length, mi.Vector3f(1, 0, 0))
        if "normal" in self.maps:
            side = dr.sign(si.shape.eval_attribute_1("vertex_side", si, active))
            slopes = self.maps["normal"].eval_3(si, active)
            across = mi.Vector3f(-t.y, t.x, 0) * side
            n = mi.Normal3f(dr.normalize(t * slopes[0] + across * slopes[1] + mi.Vector3f(0, 0, 1)))
            t = dr.normalize(t - n * dr.dot(n, t))
        turn = self.base["turn"]
        t = turn.x * t + turn.y * dr.cross(n, t)
        return mi.Frame3f(t, dr.cross(n, t), n)


class _Here:
    """The formula of `mixture` with parameters of its own at each point."""

    def __init__(self, plugin: Varying, found: dict) -> None:
        self.__dict__ |= vars(plugin) | {"facets": plugin.facets} | found


# A plugin has one base, so what holds other parameters borrows its methods.
for _name, _method in vars(Mixture).items():
    if isfunction(_method) and _name != "__init__":
        setattr(_Here, _name, _method)

mi.register_bsdf("varying", Varying)
