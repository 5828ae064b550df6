#include "environment.glsl"

// What arrives from a direction where nothing stands in the way.
vec3 incoming(vec3 world, float lod) {
    return environment(world, lod);
}

// How much of a light is seen.
float light_visibility(int light, vec3 world) {
    return 1.0;
}
