#include "brdf.glsl"

float pdf_half_vector(float D, vec3 h, float wo_h) {
    return D * h.z / (4.0 * wo_h);
}

// Density of samples of GGX, Beckmann and a cosine together, per steradian; integrates to their
// number.
float sample_density(vec3 wi, vec3 wo, Material m, ivec3 count) {
    float wo_h = 0.5 * length(wi + wo); // as in brdf.glsl: f and density err alike and cancel
    vec3 h = (wi + wo) / (2.0 * wo_h);
    float density = 0.0;
#ifdef D_GGX
    density += float(count.x) * pdf_half_vector(D_ggx(h, m.alpha), h, wo_h);
#endif
#ifdef D_BECKMANN
    density += float(count.y) * pdf_half_vector(D_beckmann(h, m.alpha), h, wo_h);
#endif
#ifdef COSINE
    density += float(count.z) * wi.z * INV_PI;
#endif
    return density;
}
