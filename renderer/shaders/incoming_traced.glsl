#ifdef LIGHTS
#define LIT_HITS
#endif
#include "here.glsl"
#include "corners.glsl"
#include "occluded_lights.glsl"
#include "surface_light.glsl"

const int FEW = 8; // directions of what a ray hits

// What arrives from a direction, for lobes finer than what is baked: a ray tells, except where
// nothing can be there.
vec3 incoming(vec3 world, float lod) {
    if (clear(world)) return environment(world, lod);
#ifdef INTERREFLECTION
    Hit hit = trace(here_point, world, false);
    if (hit.triangle < 0) return environment(world, lod);
    if (!hit.front) return vec3(0.0);
    uint from[3] = here_vertices;
    vec3 weights = here_weights;
#ifdef LOST_LIGHT
    float row = lost_row;
#endif
    uvec4 corner = corners_of(hit.triangle);
    here_vertices = uint[](corner.x, corner.y, corner.z);
    here_weights = hit.weights;
    vec3 L = surface_light(-world, int(corner.w), FEW, 0, 1, incoming_share(lod), hit.t);
    here_vertices = from;
    here_weights = weights;
#ifdef LOST_LIGHT
    lost_row = row;
#endif
    return L;
#else
    return blocked(here_point, world) ? vec3(0.0) : environment(world, lod);
#endif
}
