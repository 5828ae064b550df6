#include "material.glsl"

// The material that is drawn.
uniform vec3 albedo;
uniform vec3 f0;
uniform WIDTH alpha;
uniform vec2 weight_d;
uniform vec2 weight_g;
#ifdef FRESNEL_F82
uniform vec3 f82;
#endif
#if defined(FRESNEL_METAL) || defined(FRESNEL_DIELECTRIC)
uniform float metallic;
uniform float eta;
uniform vec3 metal_eta;
uniform vec3 metal_k;
#endif
#ifdef MULTISCATTER
uniform vec3 multiscatter;
#endif

#ifdef LOST_LIGHT
uniform float drawn_row;
#endif

Material drawn_material() {
    Material m;
#ifdef LOST_LIGHT
    lost_row = drawn_row;
#endif
    m.albedo = albedo;
    m.f0 = f0;
    m.alpha = alpha;
    m.weight_d = weight_d;
    m.weight_g = weight_g;
#ifdef FRESNEL_F82
    m.f82 = f82;
#endif
#if defined(FRESNEL_METAL) || defined(FRESNEL_DIELECTRIC)
    m.metallic = metallic;
    m.eta = eta;
    m.metal_eta = metal_eta;
    m.metal_k = metal_k;
#endif
#ifdef MULTISCATTER
    m.multiscatter = multiscatter;
#endif
    return m;
}
