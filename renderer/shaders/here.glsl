#include "environment.glsl"
#include "octahedral.glsl"
#include "rows.glsl"

#include "here_point.glsl"

uniform usampler2D open_bits;
#ifdef INTERREFLECTION
uniform usampler2D sight_index;   // of each vertex and coarse direction, or all ones
uniform sampler2D local_radiance; // of each sight,
uniform int sight_shift;          // or of so many together, as its logarithm
#endif

bool bit(usampler2D bits, uint vertex, int cell) {
    uint word = texelFetch(bits, row_texel(int(vertex) * (SIDE * SIDE / 32) + (cell >> 5)), 0).x;
    return (word >> uint(cell & 31) & 1u) != 0u;
}

// The vertices that stand around, or the one that light is asked for at.
#ifdef AT_VERTEX
const int AROUND = 1;
#else
const int AROUND = 3;
#endif

// What shines on a vertex from a coarse direction, out of what is not open.
vec3 sight_of(uint vertex, int coarse) {
#ifdef INTERREFLECTION
    uint sight = texelFetch(sight_index, row_texel(int(vertex) * (SEEN * SEEN) + coarse), 0).x;
    if (sight != 0xFFFFFFFFu) return texelFetch(local_radiance, row_texel(int(sight) >> sight_shift), 0).rgb;
#endif
    return vec3(0.0);
}

// Other surfaces' light from a direction, by what was baked at the vertices around; `visibility` is
// the share of these from which it is open.
vec3 baked_surfaces(vec3 world, inout float visibility) {
    int cell = octahedral_cell(world);
    vec3 L = vec3(0.0);
    for (int k = 0; k < AROUND; ++k) {
        if (bit(open_bits, here_vertices[k], cell)) visibility += here_weights[k];
        else L += here_weights[k] * sight_of(here_vertices[k], cell / PER_SEEN);
    }
    return L;
}

vec3 baked(vec3 world, float lod) {
    float visibility = 0.0;
    vec3 L = baked_surfaces(world, visibility);
    if (visibility > 0.0) L += visibility * environment(world, lod);
    return L;
}

// The share of the vertices around from which a direction is open.
float baked_visibility(vec3 world) {
    int cell = octahedral_cell(world);
    float visibility = 0.0;
    for (int k = 0; k < AROUND; ++k) {
        if (bit(open_bits, here_vertices[k], cell)) visibility += here_weights[k];
    }
    return visibility;
}
