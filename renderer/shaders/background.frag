#version 330
#include "radiance.glsl"
in vec2 uv;
uniform vec3 forward; // view direction, and the half extents of the image plane at distance 1
uniform vec3 right;
uniform vec3 up;
layout(location = 0) out vec4 colour;

void main() {
    vec2 p = 2.0 * uv - 1.0;
    colour = vec4(radiance(normalize(forward + p.x * right + p.y * up), 0.0), 1.0);
}
