#include "polar_map.glsl"

uniform sampler2D irradiance_exact;

// E(n) of the whole environment.
vec3 exact_irradiance(vec3 n, float turn) {
    return polar_map(irradiance_exact, n, turn);
}
