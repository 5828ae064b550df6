"""The case's model as a Mitsuba BSDF, the plugin `mixture`.

| parameter  | type    | meaning                                                    |
| ---------- | ------- | ---------------------------------------------------------- |
| `albedo`   | 3 reals | albedo of the diffuse lobe, already scaled by 1 - metallic |
| `f0`       | 3 reals | specular reflectance at normal incidence                   |
| `alpha`    | real    | microfacet width (roughness squared)                       |
| `weight`   | real    | share of GGX in D; the rest is Beckmann                    |
| `weight_g` | real    | share of GGX's masking in G; the rest is the V-cavity's    |

With h the half vector, c the albedo and all directions in the shading frame,

    f = (1 - F(h.wi)) c / pi + F(h.wi) D(h) G(wi, wo, h) / (4 n.wi n.wo)
    F = f0 + (1 - f0) (1 - h.wi)^5                                    Schlick 1994, eq. 15
    D = weight D_ggx + (1 - weight) D_beckmann                        Walter et al. 2007, eq. 33, 25
    G = weight_g G1(wi) G1(wo) + (1 - weight_g) min(1, 2 n.h min(n.wi, n.wo) / wo.h)
                        Walter et al. 2007, eq. 34; Cook and Torrance 1982, eq. 5

and f = 0 unless n.wi > 0 and n.wo > 0. Sampling draws from the diffuse lobe (cosine) or from the
visible normals of one NDF: GGX by Dupuy and Benyoub 2023 (spherical caps), Beckmann by Jakob 2014
(Mitsuba's own routine). The density is that of all three together. Parameters are opaque to
Dr.Jit, so that a compiled kernel serves every value; only a weight of 0 takes a lobe out.
"""

import drjit as dr

from reference.variant import mitsuba

mi = mitsuba()

# Least share of samples for the specular lobe: a dim but sharp reflection of a lamp is where
# the noise is, and the cosine lobe's samples cannot find it.
SPECULAR_SHARE = 0.3


class Mixture(mi.BSDF):
    """The plugin. Mitsuba's wi looks to the eye and wo to the light; f is symmetric in them."""

    def __init__(self, props: mi.Properties) -> None:
        super().__init__(props)
        weight, weight_g = float(props["weight"]), float(props["weight_g"])
        albedo, f0 = list(props["albedo"]), list(props["f0"])
        self.has = {
            "ggx": weight > 0,
            "beckmann": weight < 1,
            "smith": weight_g > 0,
            "vcavity": weight_g < 1,
            "diffuse": max(albedo) > 0,
        }
        self.albedo, self.f0 = mi.Color3f(albedo), mi.Color3f(f0)
        self.alpha = mi.Float(float(props["alpha"]))
        self.weight, self.weight_g = mi.Float(weight), mi.Float(weight_g)
        dr.make_opaque(self.albedo, self.f0, self.alpha, self.weight, self.weight_g)
        self.m_flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
        if self.has["diffuse"]:
            self.m_flags |= mi.BSDFFlags.DiffuseReflection
        self.m_components = [self.m_flags]

    def eval(self, ctx, si, wo, active=True):
        """f cos(theta_o), (sr^-1)."""
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        """Density of `sample` at wo, (sr^-1)."""
        return self.eval_pdf(ctx, si, wo, active)[1]

    def eval_pdf(self, ctx, si, wo, active=True):
        """Both at once: they share D, the costly part."""
        wi = si.wi
        active = active & (wi.z > 0) & (wo.z > 0)
        # wi.h is half the length of wi + wo; their dot product would cancel where both graze.
        length = dr.norm(wi + wo)
        h, wi_h = (wi + wo) / length, length / 2
        ggx = D_ggx(h, self.alpha) if self.has["ggx"] else 0
        beckmann = D_beckmann(h, self.alpha) if self.has["beckmann"] else 0
        F = F_schlick(self.f0, wi_h)
        D = self.weight * ggx + (1 - self.weight) * beckmann
        f = F * (D * self._masking_over_cosines(wi, wo, h, wi_h))
        if self.has["diffuse"]:
            f += (1 - F) * self.albedo * dr.inv_pi

        share_ggx, share_beckmann, share_diffuse = self._shares(wi)
        density = share_diffuse * wo.z * dr.inv_pi
        if self.has[
            "ggx"
        ]:  # D G1(wi) / (4 n.wi), by Heitz 2014, eq. 17 and the Jacobian 1 / (4 wi.h)
            density += share_ggx * ggx / (4 * projected_area_ggx(wi, self.alpha))
        if self.has["beckmann"]:
            density += share_beckmann * beckmann / (4 * projected_area_beckmann(wi, self.alpha))
        return f * wo.z & active, dr.select(active, density, 0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        """Draw wo: `sample1` chooses the lobe, `sample2` the direction."""
        wi = si.wi
        share_ggx, share_beckmann, _ = self._shares(wi)
        wo = mi.warp.square_to_cosine_hemisphere(sample2)
        if self.has["ggx"]:
            wo = dr.select(
                sample1 < share_ggx, mi.reflect(wi, visible_ggx(wi, sample2, self.alpha)), wo
            )
        if self.has["beckmann"]:
            chosen = (sample1 >= share_ggx) & (sample1 < share_ggx + share_beckmann)
            wo = dr.select(chosen, mi.reflect(wi, visible_beckmann(wi, sample2, self.alpha)), wo)
        value, density = self.eval_pdf(ctx, si, wo, active & (wi.z > 0))
        bs = dr.zeros(mi.BSDFSample3f)
        bs.wo, bs.pdf, bs.eta = wo, density, 1
        bs.sampled_component, bs.sampled_type = 0, mi.UInt32(+self.m_flags)
        return bs, value / density & (density > 0)

    def traverse(self, callback):
        for name in ("albedo", "f0", "alpha", "weight", "weight_g"):
            callback.put(name, getattr(self, name), mi.ParamFlags.Differentiable)

    def to_string(self):
        names = ("albedo", "f0", "alpha", "weight", "weight_g")
        return f"Mixture[{', '.join(f'{name}={getattr(self, name)}' for name in names)}]"

    def _shares(self, wi):
        """Chances that GGX, Beckmann and the cosine lobe are drawn; they sum to 1."""
        if self.has["diffuse"]:
            F = dr.mean(F_schlick(self.f0, wi.z))
            diffuse = (1 - F) * dr.mean(self.albedo)
            specular = dr.maximum(F / (F + diffuse), SPECULAR_SHARE)
        else:
            specular = mi.Float(1)
        # Where only one NDF is left it gets every specular sample.
        weight = (
            self.weight if self.has["ggx"] and self.has["beckmann"] else mi.Float(self.has["ggx"])
        )
        return specular * weight, specular * (1 - weight), 1 - specular

    def _masking_over_cosines(self, wi, wo, h, wi_h):
        """G / (4 n.wi n.wo), in forms that stay finite at grazing angles."""
        total = mi.Float(0)
        if self.has["smith"]:  # G1(w) / (2 n.w) = 1 / (2 projected area)
            area = projected_area_ggx(wi, self.alpha) * projected_area_ggx(wo, self.alpha)
            total += self.weight_g / (4 * area)
        if self.has["vcavity"]:
            low, high = dr.minimum(wi.z, wo.z), dr.maximum(wi.z, wo.z)
            open_share = dr.minimum(1 / (4 * low), h.z / (2 * wi_h))
            total += (1 - self.weight_g) * open_share / high
        return total


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
