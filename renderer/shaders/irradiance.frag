#version 330
#include "radiance.glsl"
in vec2 uv;
uniform int level; // of the radiance map to sum over
layout(location = 0) out vec4 irradiance;

// E(n) = integral of L cos: the sum over every texel of a level, each with its exact solid angle.
void main() {
    vec3 n = direction_from_latlong(uv, 0.0);
    ivec2 size = textureSize(radiance_map, level);
    ivec2 base = textureSize(radiance_map, 0);
    vec3 sum = vec3(0.0);
    for (int y = 0; y < size.y; ++y) {
        // The band of polar angles of this row, from row-aligned coordinates.
        vec2 edge = vec2(float(y), float(y + 1)) * float(base.y) / float(size.y) - 0.5;
        vec2 theta = clamp(edge / max(float(base.y) - 1.0, 1.0), 0.0, 1.0) * PI;
        float weight = 2.0 * PI / float(size.x) * (cos(theta.x) - cos(theta.y));
        float middle = 0.5 * (theta.x + theta.y);
        for (int x = 0; x < size.x; ++x) {
            vec3 l = direction_from_latlong(vec2((float(x) + 0.5) / float(size.x), middle / PI), 0.0);
            sum += weight * max(dot(n, l), 0.0) * texelFetch(radiance_map, ivec2(x, y), level).rgb;
        }
    }
    irradiance = vec4(sum, 1.0);
}
