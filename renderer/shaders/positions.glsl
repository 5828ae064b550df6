#include "rows.glsl"

uniform sampler2D positions; // of each vertex, from the scene's middle; its curvature

vec3 position_of(uint vertex) {
    return texelFetch(positions, row_texel(int(vertex)), 0).xyz;
}
