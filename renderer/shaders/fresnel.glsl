#include "material.glsl"
#include "fresnel_schlick.glsl"
#ifdef FRESNEL_F82
#include "fresnel_f82.glsl"
#endif
#ifdef FRESNEL_METAL
#include "fresnel_conductor.glsl"
#endif
#ifdef FRESNEL_DIELECTRIC
#include "fresnel_dielectric.glsl"
#endif

// F by the case's model: Schlick's, F82, or the Fresnel equations, of which a part that metallic
// leaves without weight is not compiled in.
vec3 fresnel(Material m, float cos_theta) {
#if defined(FRESNEL_F82)
    return F_f82(m.f0, m.f82, cos_theta);
#elif defined(FRESNEL_METAL) || defined(FRESNEL_DIELECTRIC)
    vec3 F = vec3(0.0);
#ifdef FRESNEL_METAL
    F += m.metallic * F_conductor(m.metal_eta, m.metal_k, cos_theta);
#endif
#ifdef FRESNEL_DIELECTRIC
    F += (1.0 - m.metallic) * F_dielectric(m.eta, cos_theta);
#endif
    return F;
#else
    return F_schlick(m.f0, cos_theta);
#endif
}

// 1 - F, in forms that do not cancel where F nears 1.
vec3 one_minus_fresnel(Material m, float cos_theta) {
#if defined(FRESNEL_F82)
    return one_minus_F_f82(m.f0, m.f82, cos_theta);
#elif defined(FRESNEL_METAL) || defined(FRESNEL_DIELECTRIC)
    vec3 rest = vec3(0.0);
#ifdef FRESNEL_METAL
    rest += m.metallic * one_minus_F_conductor(m.metal_eta, m.metal_k, cos_theta);
#endif
#ifdef FRESNEL_DIELECTRIC
    rest += (1.0 - m.metallic) * one_minus_F_dielectric(m.eta, cos_theta);
#endif
    return rest;
#else
    return one_minus_F_schlick(m.f0, cos_theta);
#endif
}
