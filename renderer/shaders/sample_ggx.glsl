#include "common.glsl"

// A half vector of density D_ggx(h) h.z. Walter et al. 2007, eq. 35 and 36.
vec3 sample_ggx(vec2 u, float alpha) {
    float tan2 = alpha * alpha * u.x / max(1.0 - u.x, LEAST_REST);
    float cos_theta = inversesqrt(1.0 + tan2);
    float sin_theta = sqrt(tan2) * cos_theta;
    return vec3(sin_theta * cos(2.0 * PI * u.y), sin_theta * sin(2.0 * PI * u.y), cos_theta);
}
