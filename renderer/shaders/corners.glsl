#include "rows.glsl"

// The vertices of each triangle, counted through the scene, and the number from 0 of its object.
uniform usampler2D corners;

uvec4 corners_of(int triangle) {
    return texelFetch(corners, row_texel(triangle), 0);
}
