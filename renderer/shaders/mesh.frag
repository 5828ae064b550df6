#version 330
#include "reflected.glsl"
centroid in vec3 world_normal;
centroid in vec3 to_eye;
layout(location = 0) out vec4 colour;

void main() {
    colour = vec4(reflected(normalize(world_normal), normalize(to_eye), 0, 1), 1.0);
}
