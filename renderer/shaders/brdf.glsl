#include "mixture.glsl"
#include "fresnel.glsl"
#include "material.glsl"
#ifdef MAP_NORMAL
#include "mapped_masking.glsl"
#endif
#if defined(KD_INTERFACE) || defined(KD_CONSERVING) || defined(MULTISCATTER)
#include "lost_light.glsl"
#define LOST_LIGHT
#endif

// Light that comes back from everywhere: diffuse, or off a second facet.
#if defined(DIFFUSE) || defined(MULTISCATTER)
#define COSINE
#endif

// A cosine below this is rounding (6e-8 of a dot product), and 1 / (n.wi n.wo) would leave float32.
const float HORIZON = 1e-9;

// Cook-Torrance with the diffuse lobe under the model's kd; by default kd = 1 - F(h.wi), the paper's
// eq. 3. Returns f, (sr^-1), without the cosine.
vec3 brdf(vec3 wi, vec3 wo, Material m) {
    if (min(wi.z, wo.z) < HORIZON) return vec3(0.0);
    // wo.h is half the length of wi + wo: their dot product would cancel where both graze.
    float wo_h = 0.5 * length(wi + wo);
    vec3 h = (wi + wo) / (2.0 * wo_h);
    vec3 F = fresnel(m, wo_h);
    float D = D_mixture(h, m.alpha, m.weight_d);
#ifdef MAP_NORMAL
    float G = mapped_masking(wi, wo, h, wo_h, m);
#else
    float G = G_mixture(wi, wo, h, wo_h, m.alpha, m.weight_g);
#endif
    vec3 f = F * (D * G / (4.0 * wi.z * wo.z));
#ifdef LOST_LIGHT
    vec4 lost = lost_light_at(wi.z) * lost_light_at(wo.z);
#endif
#ifdef MULTISCATTER
    f += m.multiscatter * (lost.a * INV_PI); // Kulla and Conty 2017
#endif
#if defined(DIFFUSE) && !defined(SPECULAR_LIGHT)
#if defined(KD_INTERFACE)
    f += dot(lost.xy, m.weight_d) * m.albedo * INV_PI; // through the interface of each NDF
#elif defined(KD_CONSERVING)
    f += lost.rgb * m.albedo * INV_PI; // Kelemen and Szirmay-Kalos 2001, eq. 4
#elif defined(MAP_NORMAL)
    f += one_minus_fresnel(m, wo_h) * m.albedo * (INV_PI * m.upright);
#else
    f += one_minus_fresnel(m, wo_h) * m.albedo * INV_PI;
#endif
#endif
    return f;
}
