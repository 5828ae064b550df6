#include "here.glsl"
#include "occluded_lights.glsl"

// What arrives from a direction: the environment where it is open, else other surfaces' light.
vec3 incoming(vec3 world, float lod) {
    return baked(world, lod);
}
