#include "here.glsl"
#include "corners.glsl"
#include "trace.glsl"
#include "surface_light.glsl"

// The light that comes from a direction, for lobes finer than what is baked: a ray, except where
// every vertex around surely sees nothing there.
uniform usampler2D clear_bits;

vec3 incoming(vec3 world, float lod) {
    int cell = octahedral_cell(world);
    bool clear = bit(clear_bits, here_vertices[0], cell) && bit(clear_bits, here_vertices[1], cell)
        && bit(clear_bits, here_vertices[2], cell);
    if (clear) return radiance(world, lod);
    Hit hit = trace(here_point, world);
    if (hit.triangle < 0) return radiance(world, lod);
#ifdef INTERREFLECTION
    uint from[3] = here_vertices;
    vec3 weights = here_weights;
    uvec4 corner = corners_of(hit.triangle);
    here_vertices = uint[](corner.x, corner.y, corner.z);
    here_weights = hit.weights;
    vec3 L = hit.front ? surface_light(-world, int(corner.w)) : vec3(0.0);
    here_vertices = from;
    here_weights = weights;
    return L;
#else
    return vec3(0.0);
#endif
}
