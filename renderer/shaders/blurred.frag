#version 330
#include "radiance.glsl"
#include "frame.glsl"
in vec2 uv;
uniform int taps;
uniform float share; // solid angle of the samples that will read this level
uniform vec2 size;
#ifndef ORDER
#define ORDER 4
#endif
#ifndef SPREAD
#define SPREAD 0.42
#endif
layout(location = 0) out vec4 blurred;

void main() {
    float rows = float(textureSize(radiance_map, 0).y);
    float polar = clamp((uv.y * rows - 0.5) / max(rows - 1.0, 1.0), 0.0, 1.0);
    vec3 axis = direction_from_latlong(vec2(uv.x, polar), 0.0);
    mat3 to_world = tangent_frame(axis);
    // von Mises and Fisher: variance 1 / kappa an axis.
    float kappa = 1.0 / (SPREAD * share);
    float least = exp(-2.0 * kappa);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < taps; ++i) {
        float u = (float(i) + 0.5) / float(taps);
        float c = log(1.0 - u * (1.0 - least)); // kappa (cos - 1)
        float cos_theta = 1.0 + c / kappa, sin_theta = sqrt(max(1.0 - cos_theta * cos_theta, 0.0));
        float phi = 2.0 * PI * fract(0.618033988749895 * float(i));
        vec3 world = to_world * vec3(sin_theta * cos(phi), sin_theta * sin(phi), cos_theta);
        float pdf = kappa * exp(c) / (2.0 * PI * (1.0 - least));
        float w = 1.0;
#if ORDER == 4
        w = 2.0 + c;
        if (kappa < 2.0) w = 1.0;
#endif
        sum += w * vec4(radiance(world, radiance_lod(world, pdf, float(taps))), 1.0);
    }
    blurred = vec4(sum.rgb / sum.a, 1.0);
}
