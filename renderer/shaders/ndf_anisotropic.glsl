#include "common.glsl"

// Facets whose slopes differ along the tangent and across it: those of width 1, with their slopes
// stretched by alpha (Heitz 2014, 5.3).

float slope2(vec3 h, vec2 alpha) {
    vec2 s = h.xy / alpha;
    return dot(s, s);
}

// Heitz 2014, eq. 85.
float D_ggx(vec3 h, vec2 alpha) {
    if (h.z <= 0.0) return 0.0;
    float t = slope2(h, alpha) + h.z * h.z;
    return INV_PI / (alpha.x * alpha.y * t * t);
}

// Walter et al. 2007, eq. 25, stretched.
float D_beckmann(vec3 h, vec2 alpha) {
    float z2 = h.z * h.z;
    if (h.z <= 1e-6) return 0.0;
    return exp(-slope2(h, alpha) / z2) * INV_PI / (alpha.x * alpha.y * z2 * z2);
}
