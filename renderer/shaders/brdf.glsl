#include "mixture.glsl"
#include "fresnel_schlick.glsl"
#include "material.glsl"

// A cosine below this is rounding (6e-8 of a dot product), and 1 / (n.wi n.wo) would leave float32.
const float HORIZON = 1e-9;

// Cook-Torrance with kd = 1 - F(h.wi): the paper's eq. 3. Returns f, (sr^-1), without the cosine.
vec3 brdf(vec3 wi, vec3 wo, Material m) {
    if (min(wi.z, wo.z) < HORIZON) return vec3(0.0);
    // wo.h is half the length of wi + wo: their dot product would cancel where both graze.
    float wo_h = 0.5 * length(wi + wo);
    vec3 h = (wi + wo) / (2.0 * wo_h);
    vec3 F = F_schlick(m.f0, wo_h);
    float D = D_mixture(h, m.alpha, m.weight_d);
    float G = G_mixture(wi, wo, h, wo_h, m.alpha, m.weight_g);
    vec3 f = F * (D * G / (4.0 * wi.z * wo.z));
#if defined(DIFFUSE) && !defined(SPECULAR_LIGHT)
    f += one_minus_F_schlick(m.f0, wo_h) * m.albedo * INV_PI;
#endif
    return f;
}
