#include "common.glsl"

// -log(1 - u), by its series where 1 - u would round u's digits away (u^7 / 7 is 1e-9 of it).
float minus_log_rest(float u) {
    if (u < 0.05) {
        return u * (1.0 + u * (1.0 / 2.0 + u * (1.0 / 3.0 + u * (1.0 / 4.0 + u * (1.0 / 5.0 + u / 6.0)))));
    }
    return -log(max(1.0 - u, LEAST_REST));
}

// A half vector of density D_beckmann(h) h.z. Walter et al. 2007, eq. 28 and 29.
vec3 sample_beckmann(vec2 u, float alpha) {
    float tan2 = alpha * alpha * minus_log_rest(u.x);
    float cos_theta = inversesqrt(1.0 + tan2);
    float sin_theta = sqrt(tan2) * cos_theta;
    return vec3(sin_theta * cos(2.0 * PI * u.y), sin_theta * sin(2.0 * PI * u.y), cos_theta);
}
