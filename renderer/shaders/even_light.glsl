#include "sky.glsl"

// What shines on an even lobe, E(n), but for lights.
vec3 even_irradiance(vec3 n) {
    return sky_irradiance(n);
}
