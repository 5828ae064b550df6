#include "here.glsl"

// Where nothing stands in a direction or just beside it, as seen from any vertex around.
uniform usampler2D clear_bits;
// The first lights hold most of the light of all.
const int TRACED_LIGHTS = 2;

bool clear(vec3 world) {
    int cell = octahedral_cell(world);
    return bit(clear_bits, here_vertices[0], cell) && bit(clear_bits, here_vertices[1], cell)
        && bit(clear_bits, here_vertices[2], cell);
}
