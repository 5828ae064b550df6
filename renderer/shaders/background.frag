#version 330
#include "radiance.glsl"
#include "eye_ray.glsl"
uniform float pixel_area; // of the image plane at distance 1
layout(location = 0) out vec4 colour;

void main() {
    vec3 ray = eye_ray();
    float distance = length(ray);
    // The box filter over a pixel: the level whose texel is as large as the pixel.
    float solid_angle = pixel_area / (distance * distance * distance);
    vec3 world = ray / distance;
    colour = vec4(radiance(world, radiance_lod(world, 1.0 / solid_angle, 1.0)), 1.0);
}
