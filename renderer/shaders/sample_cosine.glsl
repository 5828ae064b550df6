#include "common.glsl"

// A direction of density cos / pi (Malley's method; Pharr et al. 2016, 13.6.3).
vec3 sample_cosine(vec2 u) {
    float r = sqrt(u.x);
    return vec3(r * cos(2.0 * PI * u.y), r * sin(2.0 * PI * u.y), sqrt(1.0 - u.x));
}
