#include "common.glsl"

// A normal of GGX as wo sees them, of density D_ggx(h) G1_ggx(wo) wo.h / n.wo. Dupuy and Benyoub
// 2023, listing 3: in stretched space a point of the cap about wo.
vec3 visible_ggx(vec2 u, vec3 wo, float alpha) {
    vec3 stretched = normalize(vec3(wo.xy * alpha, wo.z));
    float z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
    float r = sqrt(max(1.0 - z * z, 0.0)), phi = 2.0 * PI * u.x;
    vec3 h = vec3(r * cos(phi), r * sin(phi), z) + stretched;
    return normalize(vec3(h.xy * alpha, max(h.z, 0.0)));
}
