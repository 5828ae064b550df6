#include "here.glsl"
#include "clear.glsl"
#include "corners.glsl"
#include "trace.glsl"
#include "surface_light.glsl"

const int FEW = 8; // directions of what a ray hits

// What arrives from a direction, for lobes finer than what is baked: a ray tells, except where
// nothing can be there.
vec3 incoming(vec3 world, float lod) {
    if (clear(world)) return environment(world, lod);
    Hit hit = trace(here_point, world);
    if (hit.triangle < 0) return environment(world, lod);
    vec3 L = vec3(0.0);
#ifdef INTERREFLECTION
    uint from[3] = here_vertices;
    vec3 weights = here_weights;
    uvec4 corner = corners_of(hit.triangle);
    here_vertices = uint[](corner.x, corner.y, corner.z);
    here_weights = hit.weights;
    if (hit.front) L = surface_light(-world, int(corner.w), FEW, 0, 1, 0.0);
    here_vertices = from;
    here_weights = weights;
#endif
    return L;
}

float light_visibility(int light, vec3 world) {
    if (clear(world)) return 1.0;
    if (light >= TRACED_LIGHTS) return baked_visibility(world);
    return trace(here_point, world).triangle < 0 ? 1.0 : 0.0;
}
