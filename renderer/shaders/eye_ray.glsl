#include "picture.glsl"

// View direction, and the half extents of the image plane at distance 1.
uniform vec3 forward;
uniform vec3 right;
uniform vec3 up;

// From the eye through the centre of this pixel, of length 1 along `forward`.
vec3 eye_ray() {
    vec2 p = 2.0 * picture_pixel() / picture_size - 1.0;
    return forward + p.x * right + p.y * up;
}
