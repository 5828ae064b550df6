#include "here.glsl"

// The light that comes from a direction: the environment's where it is open, else other surfaces'.
vec3 incoming(vec3 world, float lod) {
    return baked(world, lod);
}
