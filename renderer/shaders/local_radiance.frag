#version 330
#define AT_VERTEX
#include "surface_light.glsl"
// The light that surfaces send one another: for each vertex and coarse direction in which it sees
// one, the mean radiance of the vertices there that stand for what it sees.
uniform usampler2D sights; // three of them, as transport/visibility.py packs them
uniform usampler2D sight_owner; // the vertex that sees it
uniform ivec2 sight_range; // the first that is made, and the last but one
uniform int made_shift;    // how many are made as one, as its logarithm
const int WITNESSES = 3, VERTEX_BITS = 22; // as there
const uint NOBODY = 0xFFFFFFFFu;
const int FEW = 2; // directions of each
uniform int asked; // of the witnesses
uniform vec3 ahead; // of what this bounce adds, what all later ones will
layout(location = 0) out uint radiance_there;

void main() {
    ivec2 made = ivec2(gl_FragCoord.xy);
    int i = made.y * ROW + made.x;
    if (i < sight_range.x || i >= sight_range.y) discard;
    ivec2 texel = row_texel((i << made_shift) + (1 << made_shift) / 4); // the second of four
    uvec3 witnesses = texelFetch(sights, texel, 0).xyz;
    vec3 sum = vec3(0.0);
    here_shift = fract(float(i & 0xFFFF) * vec2(0.7548776662, 0.5698402910)); // R2, Roberts 2018
    here_weights = vec3(1.0, 0.0, 0.0);
    float share = 4.0 * PI * float(1 << made_shift) / float(SEEN * SEEN * asked);
    vec3 from = position_of(texelFetch(sight_owner, texel, 0).x);
    for (int k = 0; k < asked; ++k) {
        int one = (2 * k + 1) * WITNESSES / (2 * asked);
        if (witnesses[one] == NOBODY) continue;
        uint vertex = witnesses[one] & (1u << VERTEX_BITS) - 1u;
        here_vertices[0] = vertex;
        int object = int(texelFetch(normals, row_texel(int(vertex)), 0).w);
        vec3 v = -octahedral_direction(int(witnesses[one] >> uint(VERTEX_BITS)));
        sum += surface_light(v, object, FEW, k, asked, share, distance(from, position_of(vertex)));
    }
    vec3 L = sum / float(asked);
    // Stored alike, so that the same texel tells what it was a bounce ago.
    if (ahead != vec3(0.0)) {
        L += ahead * (from_rgbe(to_rgbe(L)) - from_rgbe(texelFetch(local_radiance, made, 0).x));
    }
    radiance_there = to_rgbe(L);
}
