#include "radiance.glsl"

// The light that comes from a direction where nothing stands in the way.
vec3 incoming(vec3 world, float lod) {
    return radiance(world, lod);
}
