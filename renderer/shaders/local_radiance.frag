#version 330
// The light that surfaces send one another: for each vertex and coarse direction in which it sees
// one, the radiance from there. One material at a time; what others send is left as it is.
#include "reflected.glsl"
uniform usampler2D sights; // x as transport/visibility.py packs it, y the coarse direction
uniform sampler2D normals;
uniform ivec2 sight_range; // of those that show the material: first, and one behind the last
layout(location = 0) out vec4 colour;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    int i = texel.y * ROW + texel.x;
    if (i < sight_range.x || i >= sight_range.y) discard;
    uvec2 sight = texelFetch(sights, texel, 0).xy;
    int vertex = int(sight.x & 0xFFFFFFu);
    vec3 v = -octahedral_direction(int(sight.y) * PER_SEEN + int(sight.x >> 24u & 0x3Fu));
    here_vertices[0] = uint(vertex);
    vec3 n = normalize(texelFetch(normals, row_texel(vertex), 0).xyz);
    colour = vec4(reflected(n, v, 0, 1) * (float(sight.x >> 30u) / 3.0), 1.0);
}
