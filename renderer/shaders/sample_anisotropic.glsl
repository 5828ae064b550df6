#include "common.glsl"

// Half vectors of density D h.z: slopes of facets of width 1 (Walter et al. 2007, eq. 28 and 35),
// stretched.
vec3 stretched_slope(float tan_theta, float u, vec2 alpha) {
    return normalize(vec3(tan_theta * alpha * vec2(cos(2.0 * PI * u), sin(2.0 * PI * u)), 1.0));
}

vec3 sample_ggx(vec2 u, vec2 alpha) {
    return stretched_slope(sqrt(u.x / max(1.0 - u.x, LEAST_REST)), u.y, alpha);
}

vec3 sample_beckmann(vec2 u, vec2 alpha) {
    return stretched_slope(sqrt(minus_log_rest(u.x)), u.y, alpha);
}
