#include "environment.glsl"
#include "octahedral.glsl"
#include "rows.glsl"
#include "rgbe.glsl"

#include "here_point.glsl"

uniform sampler2D normals; // of each vertex, and the number from 0 of its object
uniform usampler2D open_bits;
#ifdef INTERREFLECTION
uniform usampler2D seen_index;     // of each vertex and coarse direction: its sight, and
uniform usampler2D local_radiance; // what shines from each sight,
uniform int sight_shift;           // or from so many together, as its logarithm
// A bit for each fine direction that is open above the number of the sight, which may be none.
const int SIGHT_BITS = 32 - PER_SEEN; // as in renderer/transport/scene.py
const uint SIGHT = (1u << SIGHT_BITS) - 1u;
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

#ifdef INTERREFLECTION
uint seen_from(uint vertex, int coarse) {
    return texelFetch(seen_index, row_texel(int(vertex) * (SEEN * SEEN) + coarse), 0).x;
}

// What shines from there, out of what is not open.
vec3 light_of(uint seen) {
    uint sight = seen & SIGHT;
    if (sight == SIGHT) return vec3(0.0);
    return from_rgbe(texelFetch(local_radiance, row_texel(int(sight) >> sight_shift), 0).x);
}
#endif

// Other surfaces' light from a direction, by what was baked at the vertices around; `visibility` is
// the share of these from which it is open.
vec3 baked_surfaces(vec3 world, inout float visibility) {
    int cell = octahedral_cell(world);
    vec3 L = vec3(0.0);
    for (int k = 0; k < AROUND; ++k) {
#ifdef INTERREFLECTION
        uint seen = seen_from(here_vertices[k], cell / PER_SEEN);
        bool open = (seen >> uint(SIGHT_BITS + cell % PER_SEEN) & 1u) != 0u;
        if (!open) L += here_weights[k] * light_of(seen);
#else
        bool open = bit(open_bits, here_vertices[k], cell);
#endif
        if (open) visibility += here_weights[k];
    }
    return L;
}

vec3 baked(vec3 world, float lod) {
    float visibility = 0.0;
    vec3 L = baked_surfaces(world, visibility);
    if (visibility > 0.0) L += visibility * environment(world, lod);
    return L;
}
