#version 330
#include "incoming.glsl"
#include "hammersley.glsl"
#include "frame.glsl"
#include "sample_cosine.glsl"
#include "lights.glsl"
in vec2 uv;
uniform int count;
uniform int rows; // of the map
layout(location = 0) out vec4 irradiance;

// E(n) over filtered samples and over the lights.
void main() {
    float v = (uv.y * float(rows) - 0.5) / float(rows - 1);
    mat3 to_world = tangent_frame(direction_from_latlong(vec2(uv.x, v), 0.0));
    vec3 sum = vec3(0.0);
    for (int i = 0; i < count; ++i) {
        vec3 wi = sample_cosine(hammersley(uint(i), uint(count)));
        sum += PI / float(count) * incoming(to_world * wi, incoming_lod(float(count) * wi.z * INV_PI));
    }
    for (int i = 0; i < light_count; ++i) {
        float z = dot(light_towards[i].xyz, to_world[2]);
        if (z > 0.0) sum += z * light_share(i, incoming_lod(float(count) * z * INV_PI)) * light_irradiance[i].rgb;
    }
    irradiance = vec4(sum, 1.0);
}
