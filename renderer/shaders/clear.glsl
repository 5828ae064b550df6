#include "here.glsl"

uniform usampler2D clear_bits;

// Whether nothing stands in a direction or just beside it, as seen from every vertex around.
bool clear(vec3 world) {
    int cell = octahedral_cell(world);
    for (int k = 0; k < AROUND; ++k) {
        if (!bit(clear_bits, here_vertices[k], cell)) return false;
    }
    return true;
}
