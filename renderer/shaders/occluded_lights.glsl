#include "here.glsl"
#include "trace.glsl"

uniform usampler2D clear_bits;
// The first lights hold most of the light of all.
const int TRACED_LIGHTS = 2;

// Whether nothing stands in a direction or just beside it, as seen from every vertex around.
bool clear(vec3 world) {
    int cell = octahedral_cell(world);
    return bit(clear_bits, here_vertices[0], cell) && bit(clear_bits, here_vertices[1], cell)
        && bit(clear_bits, here_vertices[2], cell);
}

// How much of a light is seen: shadows of what is small are sharper than what is baked.
float light_visibility(int light, vec3 world, bool faint) {
    if (clear(world)) return 1.0;
    if (faint || light >= TRACED_LIGHTS) return baked_visibility(world);
    return blocked(here_point, world) ? 0.0 : 1.0;
}
