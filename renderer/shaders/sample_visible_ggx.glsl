#include "common.glsl"
#include "masking_smith.glsl"

// A half vector of density G1(wo) D_ggx(h) wo.h / wo.z: of the facets that wo sees.
// Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps", listing 3.
vec3 sample_visible_ggx(vec2 u, vec3 wo, float alpha) {
    vec3 stretched = normalize(vec3(alpha * wo.xy, wo.z));
    float z = (1.0 - u.x) * (1.0 + stretched.z) - stretched.z;
    float r = sqrt(clamp(1.0 - z * z, 0.0, 1.0)), phi = 2.0 * PI * u.y;
    vec3 h = vec3(r * cos(phi), r * sin(phi), z) + stretched;
    return normalize(vec3(alpha * h.xy, max(h.z, 1e-9)));
}
