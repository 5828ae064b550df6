#version 330
#include "sky.glsl"
#include "hammersley.glsl"
#include "frame.glsl"
#include "sample_cosine.glsl"
in vec2 uv;
uniform int count;
uniform int rows; // of the map
layout(location = 0) out vec4 irradiance;

// E(n) of the environment, but of the lights that its level is without.
void main() {
    float v = (uv.y * float(rows) - 0.5) / float(rows - 1);
    mat3 to_world = tangent_frame(direction_from_latlong(vec2(uv.x, v), 0.0));
    vec3 sum = vec3(0.0);
    for (int i = 0; i < count; ++i) {
        vec3 wi = sample_cosine(hammersley(uint(i), uint(count)));
        sum += PI / float(count) * environment(to_world * wi, sky_lod());
    }
    irradiance = vec4(sum, 1.0);
}
