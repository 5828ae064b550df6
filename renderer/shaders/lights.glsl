#include "light_visibility.glsl"

// The lights taken out of the environment: renderer/precompute/lights.py.
const int MOST_LIGHTS = 64; // as there
uniform int light_count;
uniform vec4 light_towards[MOST_LIGHTS];    // unit direction in the world; level from which it is gone
uniform vec4 light_irradiance[MOST_LIGHTS]; // RGB, of a surface that faces it

// What of it the environment does not show at a level: nothing one below its own, all from there on.
float light_share(int light, float lod) {
    return clamp(lod - light_towards[light].w + 1.0, 0.0, 1.0);
}
