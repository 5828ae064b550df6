#include "environment.glsl"

// What arrives from a direction on average over the share of directions that a sample stands for.
vec3 incoming(vec3 wi_world, float lod) {
    return environment(wi_world, lod);
}
