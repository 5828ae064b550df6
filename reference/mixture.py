"""The case's model as a Mitsuba BSDF, the plugin `mixture`.

| parameter   | type    | meaning                                                             |
| ----------- | ------- | ------------------------------------------------------------------- |
| `albedo`    | 3 reals | albedo of the diffuse lobe, already scaled by 1 - metallic          |
| `alpha`     | real    | microfacet width (roughness squared)                                |
| `weight`    | real    | share of GGX in D; the rest is Beckmann                             |
| `weight_g`  | real    | share of GGX's masking in G; the rest is Beckmann's                 |
| `fresnel`   | text    | `schlick`, `f82` or `exact`                                         |
| `kd`        | text    | `one-minus-fresnel`, `interface` or `conserving`                    |
| `masking`   | text    | `paper` or `smith`                                                  |
| `multiscatter` | text | `off` or `on`                                                       |
| `f0`        | 3 reals | `schlick`, `f82`: specular reflectance at normal incidence          |
| `f82`       | 3 reals | `f82`: the same where the cosine is 1/7                             |
| `metallic`  | real    | `exact`: share of the conductor in F; the rest is the dielectric    |
| `eta`       | real    | `exact`, if metallic < 1: of the dielectric, one for all channels   |
| `metal_eta`, `metal_k` | 3 reals | `exact`, if metallic > 0: of the conductor               |
| `layer_*`   | BSDF    | `interface`, per NDF in use: the `roughplastic` whose diffuse       |
|             |         | component is the diffuse lobe, before 1 - metallic                  |

With h the half vector, c the albedo and all directions in the shading frame,

    f = (1 - F(h.wi)) c / pi + F(h.wi) D(h) G(wi, wo, h) / (4 n.wi n.wo)
    D = weight D_ggx + (1 - weight) D_beckmann            Walter et al. 2007, eq. 33, 25

and f = 0 unless n.wi > 0 and n.wo > 0. The model chooses

    F  schlick            f0 + (1 - f0) (1 - h.wi)^5      Schlick 1994, eq. 15
       f82                the same less b h.wi (1 - h.wi)^6, b such that F(1/7) is f82, at least 0:
                          Kutz et al. 2021 after Lazanyi and Szirmay-Kalos 2005
       exact              metallic F_conductor + (1 - metallic) F_dielectric
    G  paper              weight_g G1(wi) G1(wo) + (1 - weight_g) G_cavity
                          G1 of GGX: Walter et al. 2007, eq. 34
                          G_cavity = min(1, 2 n.h min(n.wi, n.wo) / wo.h)
                          Cook and Torrance 1982, eq. 5
       smith              G1(wi) G1(wo), 1 / G1 = weight_g / G1_ggx + (1 - weight_g) / G1_beckmann:
                          n.w / G1(w) is the projected area of the facets (Heitz 2014, eq. 14),
                          which is linear in D; G1_beckmann with its erf (eq. 68)
    kd interface          instead of (1 - F) c / pi: (1 - metallic) times the mean, by weight, of
                          the diffuse components of `layer_ggx` and `layer_beckmann`
       conserving         instead of (1 - F) c / pi: c / pi (1 - E(wi)) (1 - E(wo)) / (1 - E_mean),
                          E(w) what the specular lobe sends back of even light to w, and E_mean its
                          mean over a hemisphere (Kelemen and Szirmay-Kalos 2001, eq. 4)
    multiscatter on       adds F_ms / pi (1 - E(wi)) (1 - E(wo)) / (1 - E_mean) to the specular
                          lobe, E with F = 1, and F_ms = F_mean^2 E_mean / (1 - F_mean (1 - E_mean))
                          (Kulla and Conty 2017); integrals in `reference.energy`

Exact Fresnel reads the constants as the truth `physical` does: metals per channel, dielectrics by
one eta, the mean of the channels, since `roughplastic` takes one. So a model with all three of
`exact`, `interface` and `smith` differs from that truth in the mixture of NDFs alone (one surface
with D G here, patches of D_i G_i there), and where one NDF has all the weight only in Mitsuba's G1
of Beckmann, a rational fit, up to .35 % off.

Component 0 is glossy, component 1 diffuse; a context may ask for either. Sampling draws from the
diffuse lobe (cosine) or from the visible normals of one NDF: GGX by Dupuy and Benyoub 2023
(spherical caps), Beckmann by Jakob 2014 (Mitsuba's own routine). The density is that of all three
together. Parameters are opaque to Dr.Jit, so that a compiled kernel serves every value; only the
model, and weights at their ends, switch code.
"""

import sys
from functools import lru_cache

import drjit as dr
import numpy as np

from reference import energy
from reference.variant import mitsuba

mi = mitsuba()

# Least share of samples for the specular lobe: a dim but sharp reflection of a lamp is where
# the noise is, and the cosine lobe's samples cannot find it.
SPECULAR_SHARE = 0.3
GLOSSY, DIFFUSE = mi.BSDFFlags.GlossyReflection, mi.BSDFFlags.DiffuseReflection


class Mixture(mi.BSDF):
    """The plugin. Mitsuba's wi looks to the eye and wo to the light; f is symmetric in them.

    `facets` is the module that has D, projected areas and visible normals.
    """

    facets = sys.modules[__name__]

    def __init__(self, props: mi.Properties) -> None:
        super().__init__(props)
        self.fresnel, self.kd, self.masking = (props[n] for n in ("fresnel", "kd", "masking"))
        weight, weight_g = float(props["weight"]), float(props["weight_g"])
        albedo = list(props["albedo"])
        metallic = float(props["metallic"]) if self.fresnel == "exact" else 0.0
        self.has = {
            "ggx": weight > 0,
            "beckmann": weight < 1,
            "masking_ggx": weight_g > 0,
            "masking_beckmann": weight_g < 1,
            "diffuse": max(albedo) > 0,
            "metal": metallic > 0,
            "dielectric": metallic < 1,
        }
        self.parameters = {
            "albedo": mi.Color3f(albedo),
            "alpha": mi.Float(float(props["alpha"])),
            "weight": mi.Float(weight),
            "weight_g": mi.Float(weight_g),
            # In double precision: 1 - w of a float32 near 1 is up to 20 % off at 1 - 1e-7.
            "rest": mi.Float(1 - weight),
            "rest_g": mi.Float(1 - weight_g),
        }
        if self.fresnel != "exact":
            for name in ("f0", "f82") if self.fresnel == "f82" else ("f0",):
                self.parameters[name] = mi.Color3f(list(props[name]))
        else:
            self.parameters["metallic"] = mi.Float(metallic)
            if self.has["metal"]:
                for name in ("metal_eta", "metal_k"):
                    self.parameters[name] = mi.Color3f(list(props[name]))
            if self.has["dielectric"]:
                self.parameters["eta"] = mi.Float(float(props["eta"]))
        dr.make_opaque(*self.parameters.values())
        self.__dict__ |= self.parameters
        self.lost, self.multiscatter = None, props.get("multiscatter", "off") == "on"
        if self.multiscatter or (self.kd == "conserving" and self.has["diffuse"]):
            self._lose_light(props)
        self.layers = {}
        if self.kd == "interface" and self.has["diffuse"]:
            self.layers = {n: props[f"layer_{n}"] for n in ("ggx", "beckmann") if self.has[n]}
        front = mi.BSDFFlags.FrontSide
        self.m_components = [GLOSSY | front] + [DIFFUSE | front] * self.has["diffuse"]
        self.m_flags = GLOSSY | front | (DIFFUSE if self.has["diffuse"] else 0)

    def eval(self, ctx, si, wo, active=True):
        """f cos(theta_o), (sr^-1)."""
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        """Density of `sample` at wo, (sr^-1)."""
        return self.eval_pdf(ctx, si, wo, active)[1]

    def eval_pdf(self, ctx, si, wo, active=True):
        """Both at once: they share D, the costly part."""
        wi = si.wi
        glossy, diffuse = self._asked(ctx)
        active = active & (wi.z > 0) & (wo.z > 0)
        # wi.h is half the length of wi + wo; their dot product would cancel where both graze.
        length = dr.norm(wi + wo)
        h, wi_h = (wi + wo) / length, length / 2
        F = self._reflected(wi_h)
        share_ggx, share_beckmann, share_cosine = self._shares(wi, glossy, diffuse)
        f, density = mi.Color3f(0), mi.Float(0)
        lost = self._lost(wi) * self._lost(wo) if self.lost else None
        if glossy:
            ggx = self.facets.D_ggx(h, self.alpha) if self.has["ggx"] else 0
            beckmann = self.facets.D_beckmann(h, self.alpha) if self.has["beckmann"] else 0
            D = self.weight * ggx + self.rest * beckmann
            f += F * (D * self._masking_over_cosines(wi, wo, h, wi_h))
            # D G1(wi) / (4 n.wi), by Heitz 2014, eq. 17 and the Jacobian 1 / (4 wi.h)
            if self.has["ggx"]:
                density += share_ggx * ggx / (4 * self.facets.projected_area_ggx(wi, self.alpha))
            if self.has["beckmann"]:
                area = self.facets.projected_area_beckmann(wi, self.alpha)
                density += share_beckmann * beckmann / (4 * area)
        if glossy and self.multiscatter:
            f += self.back * (lost.w * dr.inv_pi)
        f_cos = f * wo.z
        if diffuse or self.multiscatter:
            density += share_cosine * wo.z * dr.inv_pi
        if diffuse:
            if self.layers:
                f_cos += self._from_below(si, wo, active)
            elif self.kd == "conserving":
                f_cos += mi.Color3f(lost.x, lost.y, lost.z) * self.albedo * (dr.inv_pi * wo.z)
            else:
                f_cos += self._transmitted(wi_h) * self.albedo * (dr.inv_pi * wo.z)
        return f_cos & active, dr.select(active, density, 0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        """Draw wo: `sample1` chooses the lobe, `sample2` the direction."""
        wi = si.wi
        glossy, diffuse = self._asked(ctx)
        share_ggx, share_beckmann, _ = self._shares(wi, glossy, diffuse)
        wo = mi.warp.square_to_cosine_hemisphere(sample2)
        if glossy and self.has["ggx"]:
            wo = dr.select(
                sample1 < share_ggx,
                mi.reflect(wi, self.facets.visible_ggx(wi, sample2, self.alpha)),
                wo,
            )
        if glossy and self.has["beckmann"]:
            chosen = (sample1 >= share_ggx) & (sample1 < share_ggx + share_beckmann)
            wo = dr.select(
                chosen, mi.reflect(wi, self.facets.visible_beckmann(wi, sample2, self.alpha)), wo
            )
        value, density = self.eval_pdf(ctx, si, wo, active & (wi.z > 0))
        # The cosine lobe serves light off many facets too: glossy, if only that is asked for.
        drawn_diffuse = (sample1 >= share_ggx + share_beckmann) if diffuse else mi.Bool(False)
        bs = dr.zeros(mi.BSDFSample3f)
        bs.wo, bs.pdf, bs.eta = wo, density, 1
        bs.sampled_component = dr.select(drawn_diffuse, mi.UInt32(1), mi.UInt32(0))
        bs.sampled_type = dr.select(drawn_diffuse, mi.UInt32(+DIFFUSE), mi.UInt32(+GLOSSY))
        return bs, value / density & (density > 0)

    def traverse(self, callback):
        for name in self.parameters:
            callback.put(name, getattr(self, name), mi.ParamFlags.Differentiable)

    def to_string(self):
        values = [f"{name}={getattr(self, name)}" for name in self.parameters]
        model = [self.fresnel, self.kd, self.masking, f"multiscatter={self.multiscatter}"]
        return f"Mixture[{', '.join([*model, *values])}]"

    def _asked(self, ctx):
        """Whether a context wants the glossy and the diffuse component."""
        return (
            ctx.is_enabled(GLOSSY, 0),
            self.has["diffuse"] and ctx.is_enabled(DIFFUSE, 1),
        )

    def _shares(self, wi, glossy, diffuse):
        """Chances that GGX, Beckmann and the cosine lobe are drawn; they sum to 1."""
        if glossy and (diffuse or self.multiscatter):
            F = dr.mean(self._reflected(wi.z))
            below = (1 - F) * dr.mean(self.albedo) if diffuse else mi.Float(0)
            if self.multiscatter:
                below += dr.mean(self.back) * self._lost(wi).w * self.lost_root
            specular = dr.maximum(F / (F + below), SPECULAR_SHARE)
        else:
            specular = mi.Float(glossy)
        # Where only one NDF is left it gets every specular sample.
        weight = (
            self.weight if self.has["ggx"] and self.has["beckmann"] else mi.Float(self.has["ggx"])
        )
        return specular * weight, specular * (1 - weight), 1 - specular

    def _reflected(self, cos_theta):
        """F by the case's model, per channel."""
        if self.fresnel == "schlick":
            return F_schlick(self.f0, cos_theta)
        if self.fresnel == "f82":
            dropped = F_schlick(self.f0, cos_theta) - self._drop(cos_theta)
            return dr.maximum(dropped, 0)
        F = mi.Color3f(0)
        if self.has["dielectric"]:
            F += (1 - self.metallic) * mi.fresnel(cos_theta, self.eta)[0]
        if self.has["metal"]:
            F += self.metallic * F_conductor(self.metal_eta, self.metal_k, cos_theta)
        return F

    def _transmitted(self, cos_theta):
        """1 - F; Schlick's and F82 without the cancellation where F nears 1."""
        if self.fresnel == "exact":
            return 1 - self._reflected(cos_theta)
        c = dr.clip(cos_theta, 0, 1)
        m = 1 - c
        passed = (1 - self.f0) * (c * (1 + m * (1 + m * (1 + m * (1 + m)))))
        return dr.minimum(passed + self._drop(c), 1) if self.fresnel == "f82" else passed

    def _drop(self, cos_theta):
        """What F82 takes from Schlick's F, so that it is f82 where the cosine is 1/7."""
        c, at = dr.clip(cos_theta, 0, 1), 1 / 7
        b = (F_schlick(self.f0, mi.Float(at)) - self.f82) / (at * (1 - at) ** 6)
        return b * (c * dr.power(1 - c, 6))

    def _lose_light(self, props):
        """Tabulate what the specular lobe does not send back."""
        shape = tuple(float(props[n]) for n in ("alpha", "weight", "weight_g"))
        factors, back, root = _lost_light(
            *shape, self.masking, self.multiscatter, _constants(props)
        )
        self.lost = mi.Texture1f(mi.TensorXf(factors.astype(np.float32)), use_accel=False)
        self.back, self.lost_root = mi.Color3f(*map(float, back)), mi.Float(root)
        dr.make_opaque(self.back, self.lost_root)

    def _lost(self, w):
        """The factors of `energy.lost_light`: xyz for the diffuse lobe, w for facets."""
        texel = (energy.place(dr.clip(w.z, 0, 1)) * (energy.TEXELS - 1) + 0.5) / energy.TEXELS
        return mi.Vector4f(self.lost.eval(mi.Array1f(texel)))

    def _from_below(self, si, wo, active):
        """Diffuse light through the rough interface, f cos(theta_o)."""
        context = mi.BSDFContext()
        context.type_mask = DIFFUSE
        f_cos = mi.Color3f(0)
        for name, layer in self.layers.items():
            share = self.weight if name == "ggx" else self.rest
            f_cos += share * layer.eval(context, si, wo, active)
        return f_cos * (1 - self.metallic)

    def _masking_over_cosines(self, wi, wo, h, wi_h):
        """G / (4 n.wi n.wo), in forms that stay finite at grazing angles."""
        if self.masking == "smith":  # G1(w) / (2 n.w) = 1 / (2 projected area)
            return 1 / (4 * self._projected_area(wi) * self._projected_area(wo))
        total = mi.Float(0)
        if self.has["masking_ggx"]:
            area = self.facets.projected_area_ggx(wi, self.alpha) * self.facets.projected_area_ggx(
                wo, self.alpha
            )
            total += self.weight_g / (4 * area)
        if self.has["masking_beckmann"]:
            low, high = dr.minimum(wi.z, wo.z), dr.maximum(wi.z, wo.z)
            open_share = dr.minimum(1 / (4 * low), h.z / (2 * wi_h))
            total += self.rest_g * open_share / high
        return total

    def _projected_area(self, w):
        """n.w / G1(w) of the mixed facets: their areas add up, which makes G1 a harmonic mean."""
        area = mi.Float(0)
        if self.has["masking_ggx"]:
            area += self.weight_g * self.facets.projected_area_ggx(w, self.alpha)
        if self.has["masking_beckmann"]:
            area += self.rest_g * self.facets.projected_area_beckmann(w, self.alpha)
        return area


def _constants(props):
    """The model of F, and the parameters that it reads: what `energy` needs, to be told apart."""
    if props["fresnel"] != "exact":
        names = ("f0", "f82") if props["fresnel"] == "f82" else ("f0",)
        return (props["fresnel"], *(_triple(props[n]) for n in names))
    parts, metallic = [], float(props["metallic"])
    if metallic < 1:
        parts.append((1 - metallic, (float(props["eta"]),) * 3, (0.0,) * 3))
    if metallic > 0:
        parts.append((metallic, *(_triple(props[n]) for n in ("metal_eta", "metal_k"))))
    return ("exact", *parts)


def _triple(values):
    return tuple(float(v) for v in values)


@lru_cache(maxsize=256)
def _lost_light(alpha, weight, weight_g, masking, multiscatter, constants):
    """`energy.lost_light`, once for each surface and model."""
    model, *values = constants
    if model == "exact":
        parts = [(share, np.array(eta), np.array(k)) for share, eta, k in values]

        def fresnel(c):
            return sum(share * energy.exact(eta, k, c) for share, eta, k in parts)
    else:
        form, arrays = getattr(energy, model), [np.array(v) for v in values]

        def fresnel(c):
            return form(*arrays, c)

    return energy.lost_light(alpha, weight, weight_g, masking, fresnel, multiscatter)


def F_conductor(eta, k, cos_theta):
    """The Fresnel equations per channel, unpolarised, by Mitsuba's own function."""
    channels = zip(eta, k, strict=True)
    return mi.Color3f([mi.fresnel_conductor(cos_theta, mi.Complex2f(*c)) for c in channels])


def F_schlick(f0, cos_theta):
    """Schlick 1994, eq. 15."""
    return f0 + (1 - f0) * dr.power(dr.clip(1 - cos_theta, 0, 1), 5)


def D_ggx(h, alpha):
    """Trowbridge and Reitz 1975; sin² from components, since 1 - cos² cancels at small alpha."""
    spread = (dr.square(h.x) + dr.square(h.y)) / dr.square(alpha) + dr.square(h.z)
    return dr.inv_pi / (dr.square(alpha) * dr.square(spread)) & (h.z > 0)


def D_beckmann(h, alpha):
    """Beckmann and Spizzichino 1963; Walter et al. 2007, eq. 25; its limit at n.h = 0 is 0."""
    z2, a2 = dr.square(h.z), dr.square(alpha)
    tan2 = (dr.square(h.x) + dr.square(h.y)) / z2
    return dr.select(h.z > 1e-6, dr.exp(-tan2 / a2) * dr.inv_pi / (a2 * dr.square(z2)), 0)


def projected_area_ggx(w, alpha):
    """n.w / G1(w), the area of the facets that w sees (Heitz 2014, eq. 14) per unit of surface."""
    return (
        w.z + dr.sqrt(dr.square(w.z) + dr.square(alpha) * (dr.square(w.x) + dr.square(w.y)))
    ) / 2


def projected_area_beckmann(w, alpha):
    """n.w (1 + Lambda(w)) with the exact Lambda (Heitz 2014, eq. 68), for a = 1 / (alpha tan)."""
    sin_alpha = alpha * dr.sqrt(dr.square(w.x) + dr.square(w.y))
    a = w.z / dr.maximum(sin_alpha, 1e-12)
    tail = sin_alpha * dr.exp(-dr.square(a)) * (0.5 / dr.sqrt(dr.pi))
    return w.z * (1 + dr.erf(a)) / 2 + tail


def visible_ggx(wi, sample, alpha):
    """A normal seen from wi. Dupuy and Benyoub 2023, listing 3."""
    stretched = dr.normalize(mi.Vector3f(wi.x * alpha, wi.y * alpha, wi.z))
    z = dr.fma(1 - sample.y, 1 + stretched.z, -stretched.z)
    s, c = dr.sincos(2 * dr.pi * sample.x)
    r = dr.safe_sqrt(1 - dr.square(z))
    cap = mi.Vector3f(r * c, r * s, z) + stretched
    return dr.normalize(mi.Vector3f(cap.x * alpha, cap.y * alpha, dr.maximum(cap.z, 0)))


def visible_beckmann(wi, sample, alpha):
    """A normal seen from wi. Jakob 2014, as Mitsuba has it."""
    return mi.MicrofacetDistribution(mi.MicrofacetType.Beckmann, alpha).sample(wi, sample)[0]


mi.register_bsdf("mixture", Mixture)
