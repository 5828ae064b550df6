#version 330
#include "here.glsl"
// All that shines on each vertex: the environment's light, and other surfaces'.
uniform sampler2D direct; // of each vertex: vertex_direct.frag
uniform sampler2D flux;   // as there
const float FLUX = 255.0 / 8160.0;
layout(location = 0) out vec4 colour;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    uint vertex = uint(texel.y * ROW + texel.x);
    int first = int(vertex) * (SEEN * SEEN);
    vec3 E = vec3(0.0);
    for (int coarse = 0; coarse < SEEN * SEEN; ++coarse) {
        float through = texelFetch(flux, row_texel(first + coarse), 0).y;
        if (through > 0.0) E += through * light_of(seen_from(vertex, coarse));
    }
    colour = texelFetch(direct, texel, 0) + vec4(PI * FLUX * E, 0.0);
}
