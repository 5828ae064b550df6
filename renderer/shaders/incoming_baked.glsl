#include "radiance.glsl"
#include "octahedral.glsl"
#include "rows.glsl"

// The light that comes from a direction, by what was baked at the corners of the triangle that the
// shading point lies in: whether the direction is open, and what shines where it is not.
uniform usampler2D open_bits;
#ifdef INTERREFLECTION
uniform usampler2D sight_index;   // of each vertex and coarse direction, or all ones
uniform sampler2D local_radiance; // of each sight
#endif
// Set before shading: the vertices around, and the point's weights among them. Seen from another
// surface a vertex stands for what lies around it.
#ifdef AT_VERTEX
const int AROUND = 1;
uint here_vertices[AROUND];
const float here_weights[AROUND] = float[](1.0);
#else
const int AROUND = 3;
uint here_vertices[AROUND];
float here_weights[AROUND];
#endif

bool is_open(uint vertex, int cell) {
    uint word = texelFetch(open_bits, row_texel(int(vertex) * (SIDE * SIDE / 32) + (cell >> 5)), 0).x;
    return (word >> uint(cell & 31) & 1u) != 0u;
}

vec3 incoming(vec3 world, float lod) {
    int cell = octahedral_cell(world);
    vec3 L = vec3(0.0);
    float visibility = 0.0;
    for (int k = 0; k < AROUND; ++k) {
        if (is_open(here_vertices[k], cell)) {
            visibility += here_weights[k];
            continue;
        }
#ifdef INTERREFLECTION
        int at = int(here_vertices[k]) * (SEEN * SEEN) + cell / PER_SEEN;
        uint sight = texelFetch(sight_index, row_texel(at), 0).x;
        if (sight == 0xFFFFFFFFu) continue;
        L += here_weights[k] * texelFetch(local_radiance, row_texel(int(sight)), 0).rgb;
#endif
    }
    if (visibility > 0.0) L += visibility * radiance(world, lod);
    return L;
}
