#version 330
#include "sky.glsl"
// What shines from each coarse direction, not as blurred as its cell: too much would come past the edges
// of what blocks.
layout(location = 0) out vec4 colour;

void main() {
    int coarse = min(int(gl_FragCoord.x), SEEN * SEEN - 1); // a row is longer
    colour = vec4(environment(coarse_direction(coarse), sky_lod()), 1.0);
}
