#include "common.glsl"

// A half vector of density D_beckmann(h) h.z. Walter et al. 2007, eq. 28 and 29.
vec3 sample_beckmann(vec2 u, float alpha) {
    float tan2 = -alpha * alpha * log(max(1.0 - u.x, 1e-7));
    float cos_theta = inversesqrt(1.0 + tan2);
    float sin_theta = sqrt(tan2) * cos_theta;
    return vec3(sin_theta * cos(2.0 * PI * u.y), sin_theta * sin(2.0 * PI * u.y), cos_theta);
}
