#version 330
#include "radiance.glsl"
in vec2 uv;
uniform float pixel_area; // of the image plane at distance 1
uniform vec3 forward; // view direction, and the half extents of the image plane at distance 1
uniform vec3 right;
uniform vec3 up;
layout(location = 0) out vec4 colour;

void main() {
    vec2 p = 2.0 * uv - 1.0;
    vec3 ray = forward + p.x * right + p.y * up;
    // The box filter over a pixel: the level whose texel is as large as the pixel.
    float solid_angle = pixel_area / pow(dot(ray, ray), 1.5);
    vec3 world = normalize(ray);
    colour = vec4(radiance(world, radiance_lod(world, 1.0 / solid_angle, 1.0)), 1.0);
}
