#include "environment.glsl"
#include "octahedral.glsl"
#include "polar_map.glsl"

// The environment without lights, as far as it is known for every normal: irradiance_sky.frag.
uniform sampler2D irradiance_sky;

// Its level, that of a fine cell: lights that are not in it are to be added. In a finer one there would
// be fewer, and of what is left only shares of the sky tell how much is seen.
float sky_lod() {
    return incoming_lod(float(SIDE * SIDE) / (4.0 * PI));
}

// E(n).
vec3 sky_irradiance(vec3 n) {
    return polar_map(irradiance_sky, n, environment_turn);
}

// What E becomes where something like it was found and is known to be otherwise.
vec3 corrected(vec3 E, vec3 known, vec3 found) {
    return E * clamp(known / max(found, 1e-6 * dot(found, vec3(1.0)) + 1e-30), 0.5, 2.0);
}
