#version 330
#include "surface_light.glsl"
// The light that surfaces send one another: for each vertex and coarse direction in which it sees
// one, the radiance from there.
uniform usampler2D sights;  // x as transport/visibility.py packs it, y the coarse direction
uniform int sight_count;
const float SIGHT = 4.0 * PI / float(SEEN * SEEN); // the solid angle that one stands for
layout(location = 0) out vec4 colour;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    if (texel.y * ROW + texel.x >= sight_count) discard;
    uvec2 sight = texelFetch(sights, texel, 0).xy;
    uint vertex = sight.x & 0xFFFFFFu;
    vec3 v = -octahedral_direction(int(sight.y) * PER_SEEN + int(sight.x >> 24u & 0x3Fu));
    here_vertices = uint[](vertex, vertex, vertex);
    here_weights = vec3(1.0, 0.0, 0.0);
    int object = int(texelFetch(normals, row_texel(int(vertex)), 0).w);
    colour = vec4(surface_light(v, object, SIGHT) * (float(sight.x >> 30u) / 3.0), 1.0);
}
