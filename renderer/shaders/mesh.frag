#version 330
#include "shade.glsl"
centroid in vec3 world_normal;
centroid in vec3 to_eye;
uniform vec3 albedo;
uniform vec3 f0;
uniform float alpha;
uniform vec2 weight_d;
uniform vec2 weight_g;
layout(location = 0) out vec4 colour;

void main() {
    vec3 n = normalize(world_normal), v = normalize(to_eye);
    // An interpolated normal that faces away from the eye reflects nothing: Mitsuba's rule too.
    vec3 L = dot(n, v) > 0.0 ? shade(n, v, Material(albedo, f0, alpha, weight_d, weight_g)) : vec3(0.0);
    colour = vec4(L, 1.0);
}
