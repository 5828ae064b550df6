#version 330
#include "surface_light.glsl"
// The light that surfaces send one another: for each vertex and coarse direction in which it sees
// one, the mean radiance of the vertices there that stand for what it sees.
uniform usampler2D sights; // four of them, as transport/visibility.py packs them
uniform usampler2D sight_owner; // the vertex that sees it
uniform int sight_count;
const int WITNESSES = 4, VERTEX_BITS = 22; // as there
const uint NOBODY = 0xFFFFFFFFu;
const int FEW = 2; // directions of each
uniform int asked; // of the witnesses
layout(location = 0) out vec4 colour;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    if (texel.y * ROW + texel.x >= sight_count) discard;
    uvec4 witnesses = texelFetch(sights, texel, 0);
    vec3 sum = vec3(0.0);
    here_weights = vec3(1.0, 0.0, 0.0);
    float share = 4.0 * PI / float(SEEN * SEEN * asked);
    vec3 from = position_of(texelFetch(sight_owner, texel, 0).x);
    for (int k = 0; k < asked; ++k) {
        int i = asked == WITNESSES ? k : (2 * k + 1) * WITNESSES / (2 * asked);
        if (witnesses[i] == NOBODY) continue;
        uint vertex = witnesses[i] & (1u << VERTEX_BITS) - 1u;
        here_vertices = uint[](vertex, vertex, vertex);
        int object = int(texelFetch(normals, row_texel(int(vertex)), 0).w);
        vec3 v = -octahedral_direction(int(witnesses[i] >> uint(VERTEX_BITS)));
        sum += surface_light(v, object, FEW, k, asked, share, distance(from, position_of(vertex)));
    }
    colour = vec4(sum / float(asked), 1.0);
}
