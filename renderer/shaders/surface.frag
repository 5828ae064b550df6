#version 330
// What a pixel shows of a surface, for surface_shade.frag: its normal, and whose it is.
centroid in vec3 world_normal;
uniform float number; // the object's, from 1
layout(location = 0) out vec4 surface;

void main() {
    surface = vec4(normalize(world_normal), number);
}
