#include "here.glsl"
#include "clear.glsl"
#include "trace.glsl"

// What arrives from a direction: the environment where it is open, else other surfaces' light.
vec3 incoming(vec3 world, float lod) {
    return baked(world, lod);
}

// How much of a light is seen: shadows of what is small are sharper than what is baked.
float light_visibility(int light, vec3 world) {
    if (clear(world)) return 1.0;
    if (light >= TRACED_LIGHTS) return baked_visibility(world);
    return trace(here_point, world).triangle < 0 ? 1.0 : 0.0;
}
